! The hook in Fortran for an array of structures: hook_structures [amplitude [no]], as hook.f90. Places and velocities
! are arrays, as in two or three directions.
program hook_structures
  use bar, only: particles, h, x, v, stress, start, step => advance
  use mpmstab_hook
  use iso_c_binding, only: c_double
  implicit none
  type particle
    real(c_double) :: x(1), v(1), stress
    logical        :: active = .true.
  end type
  type(particle), target :: p(particles)
  type(mpmstab_loop)     :: loop
  character(40)          :: word
  real(c_double)         :: amplitude = 0
  integer                :: i

  call get_command_argument(1, word)
  if (word /= '') read (word, *) amplitude
  call start(amplitude)
  do i = 1, particles
    p(i) = particle([x(i)], [v(i)], stress(i))
  end do
  loop%period(1) = 1
  call mpmstab_field(loop, 'x', p(1)%x, p(2)%x, particles, place=.true.)
  call mpmstab_field(loop, 'v', p(1)%v, p(2)%v, particles, scale=1d0)
  call mpmstab_field(loop, 'stress', p(1)%stress, p(2)%stress, particles, scale=1d0)
  if (command_argument_count() < 2) then ! a second word leaves the hook out
    do while (.not. mpmstab_probe(loop, 'A.mtx', h))
      call advance()
    end do
  end if
  do i = 1, 50
    call advance()
  end do
  print '(3(1x, z16.16))', (p(i)%x, p(i)%v, p(i)%stress, i=1, particles)

contains

  subroutine advance()
    integer :: k

    do k = 1, particles
      x(k) = p(k)%x(1); v(k) = p(k)%v(1); stress(k) = p(k)%stress
    end do
    call step()
    do k = 1, particles
      p(k)%x(1) = x(k); p(k)%v(1) = v(k); p(k)%stress = stress(k)
    end do
  end subroutine
end program
