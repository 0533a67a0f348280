! An adapter for your code in Fortran. Fill in the five places, then:
!
!   gfortran -O2 -fPIC -shared -o libmine.so mine.f90
!   mpmstab spectrum -plugin ./libmine.so
!
! The four functions are those of mpmstab/plugin.h.
module mine
  use iso_c_binding
  implicit none

  ! FILL 1: the number of particles, and of numbers of a particle: all that a step changes and a later step reads.
  integer, parameter :: particles = 8, numbers = 7

  ! FILL 2: the fields of a particle in their order. One is the place. Where you know it, add the size of a usual change: "scale": 20.
  character(*), parameter :: fields = '{"name": "x", "size": 2, "place": true}, {"name": "v", "size": 2},'// &
                                      '{"name": "stress", "size": 3}'

  ! FILL 3: the number of directions, the width of a cell, and the period of each direction (null: it has no period).
  character(*), parameter :: grid = '"dim": 2, "cell_width": 0.1, "periodic": [null, null]'

  ! FILL 4: a parameter that mpmstab may set, with the value of your code.
  real(c_double) :: dt = 1d-4

  real(c_double), target         :: base(numbers, particles)
  character(kind=c_char), target :: text(4096), wrong(64)

contains

  ! FILL 5: the particles at the start, and one step, which keeps nothing but p. Set failed to 0 in both.
  subroutine start(p, failed)
    real(c_double), intent(out) :: p(numbers, particles)
    integer, intent(out)        :: failed
    p = 0; failed = 1
  end subroutine
  subroutine advance(p, failed)
    real(c_double), intent(inout) :: p(numbers, particles)
    integer, intent(out)          :: failed
    p = 0*p; failed = 1
  end subroutine

  type(c_ptr) function describe(state) bind(c, name='mpmstab_describe')
    type(c_ptr), intent(out) :: state
    character(4096)          :: line
    character(64)            :: counted, value
    integer                  :: failed

    describe = c_null_ptr
    state = c_loc(base)
    call start(base, failed)
    if (failed /= 0) return
    write (counted, '(i0)') particles
    write (value, '(es25.17)') dt
    line = '{"protocol": 1, "name": "mine", '//grid//', "particles": '//trim(counted)//', "fields": ['//fields// &
           '], "parameters": {"dt": '//trim(adjustl(value))//'}, "steps": 1}'//c_null_char
    text = transfer(line, text)
    describe = c_loc(text)
  end function

  integer(c_int) function set(name, value) bind(c, name='mpmstab_set')
    character(kind=c_char), intent(in) :: name(3)
    real(c_double), value              :: value

    set = 1
    if (any(name /= ['d', 't', c_null_char])) return
    dt = value
    set = 0
  end function

  integer(c_int) function step(steps, count, state) bind(c, name='mpmstab_step')
    integer(c_int), value         :: steps
    integer(c_int64_t), value     :: count
    real(c_double), intent(inout) :: state(numbers, count)
    integer                       :: n

    step = 1
    if (count /= particles) return
    do n = 1, steps
      call advance(state, step)
      if (step /= 0) return
    end do
  end function

  type(c_ptr) function error() bind(c, name='mpmstab_error')
    character(64) :: line

    line = 'FILL 5: the start and one step of your code'//c_null_char
    wrong = transfer(line, wrong)
    error = c_loc(wrong)
  end function
end module
