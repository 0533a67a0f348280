! The bar as a plugin in Fortran: mpmstab spectrum -plugin ./libbar.so. The three functions are those of mpmstab/plugin.h.
module bar_plugin
  use iso_c_binding
  use bar
  implicit none
  real(c_double), target                :: base(3, particles)
  character(kind=c_char), target        :: text(400)

contains

  type(c_ptr) function describe(state) bind(c, name='mpmstab_describe')
    type(c_ptr), intent(out) :: state
    character(400)           :: line

    call start(0d0)
    base(1, :) = x; base(2, :) = v; base(3, :) = stress
    state = c_loc(base)
    line = '{"protocol": 1, "name": "bar", "dim": 1, "cell_width": 0.0625, "periodic": [1.0], "particles": 32, "fields": ['// &
           '{"name": "x", "size": 1, "place": true}, {"name": "v", "size": 1, "scale": 1}, '// &
           '{"name": "stress", "size": 1, "scale": 1}], "parameters": {"dt": 0.03125}, "steps": 1}'//c_null_char
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
    real(c_double), intent(inout) :: state(3, count)
    integer                       :: n

    step = 1
    if (count /= particles) return
    x = state(1, :); v = state(2, :); stress = state(3, :)
    do n = 1, steps
      call advance()
    end do
    state(1, :) = x; state(2, :) = v; state(3, :) = stress
    step = 0
  end function
end module
