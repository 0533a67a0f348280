! An adapter for your code in Fortran. Fill in the five places, then:
!
!   gfortran -O2 -fPIC -shared -o libmine.so mine.f90
!   mpmstab spectrum -plugin ./libmine.so
!
! mpmstab chooses the particles: 10 cells each way with 2 particles each way, or those of -program_scene. The functions
! are those of mpmstab/plugin.h.
module mine
  use iso_c_binding
  implicit none

  ! FILL 1: how many numbers a particle has: all that a step changes and a later step reads, and what else differs.
  integer, parameter :: numbers = 9

  ! FILL 2: the fields of a particle in their order, with how many numbers each has. One of them is the place.
  character(*), parameter :: fields = '{"name": "x", "size": 2, "place": true}, {"name": "v", "size": 2},'// &
                                      '{"name": "stress", "size": 3}, {"name": "volume", "size": 1}, {"name": "mass", "size": 1}'

  ! FILL 3: the number of directions, and the width of a cell.
  integer, parameter :: dim = 2
  real(c_double)     :: cell_width = 0.1d0

  ! FILL 4: a parameter that mpmstab may set, with the value of your code.
  real(c_double) :: dt = 1d-4

  real(c_double)                 :: period(dim) ! mpmstab fills in: of the grid in each direction, 0 where there is none
  character(kind=c_char), target :: text(4096), wrong(64)

contains

  ! FILL 5: a particle at rest, and one step of all particles, which keeps nothing but p. Set failed to 0 in both.
  subroutine rest(p, place, volume, mass, failed)
    real(c_double), intent(out) :: p(numbers)
    real(c_double), intent(in)  :: place(dim), volume, mass
    integer, intent(out)        :: failed
    p = volume*mass*place(1); failed = 1
  end subroutine
  subroutine advance(p, failed)
    real(c_double), intent(inout) :: p(:, :)
    integer, intent(out)          :: failed
    p = 0*p; failed = 1
  end subroutine

  type(c_ptr) function describe(state) bind(c, name='mpmstab_describe')
    type(c_ptr), intent(out) :: state
    character(4096)          :: line
    character(64)            :: directions, width, value

    state = c_null_ptr
    write (directions, '(i0)') dim
    write (width, '(es25.17)') cell_width
    write (value, '(es25.17)') dt
    line = '{"protocol": 1, "name": "mine", "scenes": true, "dim": '//trim(directions)//', "cell_width": '// &
           trim(adjustl(width))//', "fields": ['//fields//'], "parameters": {"dt": '//trim(adjustl(value))//'}}'// &
           c_null_char
    text = transfer(line, text)
    describe = c_loc(text)
  end function

  integer(c_int) function scene(message, count, periods, given, state) bind(c, name='mpmstab_scene')
    type(c_ptr), value          :: message
    integer(c_int64_t), value   :: count
    real(c_double), intent(in)  :: periods(dim), given(dim + 2, count)
    real(c_double), intent(out) :: state(numbers, count)
    integer(c_int64_t)          :: i

    scene = 0
    period = periods
    do i = 1, count
      if (scene == 0) call rest(state(:, i), given(:dim, i), given(dim + 1, i), given(dim + 2, i), scene)
    end do
    if (.not. c_associated(message)) scene = 1
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

    step = 0
    do n = 1, steps
      if (step == 0) call advance(state, step)
    end do
  end function

  type(c_ptr) function error() bind(c, name='mpmstab_error')
    character(64) :: line

    line = 'FILL 5: a particle at rest and one step of your code'//c_null_char
    wrong = transfer(line, wrong)
    error = c_loc(wrong)
  end function
end module
