! The hook in Fortran: hook [amplitude [no]]. It writes A.mtx before the first step and prints the state after 50 steps.
program hook
  use bar
  use mpmstab_hook
  implicit none
  type(mpmstab_loop) :: loop
  character(40)      :: word
  real(c_double)     :: amplitude = 0
  integer            :: i

  call get_command_argument(1, word)
  if (word /= '') read (word, *) amplitude
  call start(amplitude)
  loop%period(1) = 1
  call mpmstab_field(loop, 'x', x, place=.true.)
  call mpmstab_field(loop, 'v', v, scale=1d0)
  call mpmstab_field(loop, 'stress', stress, scale=1d0)
  if (command_argument_count() < 2) then ! a second word leaves the hook out
    do while (.not. mpmstab_probe(loop, 'A.mtx', h))
      call advance()
    end do
  end if
  do i = 1, 50
    call advance()
  end do
  print '(3(1x, z16.16))', (x(i), v(i), stress(i), i=1, particles)
end program
