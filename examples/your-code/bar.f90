! A bar in Fortran, with a period of length 1: a step of MPM as it is in many codes (update stress last, hat functions).
! Density and stiffness are 1, so that waves move half a cell a step.
module bar
  use iso_c_binding, only: c_double
  implicit none
  integer, parameter     :: cells = 16, particles = 2*cells
  real(c_double)         :: h = 1d0/cells, dt = 0.5d0/cells
  real(c_double), target :: x(particles), v(particles), stress(particles)

contains

  subroutine start(amplitude)
    real(c_double), intent(in) :: amplitude
    integer                    :: i

    x = [((i - 0.5d0)*h/2, i=1, particles)]
    v = amplitude*sin(2*acos(-1d0)*x)
    stress = 0
  end subroutine

  subroutine advance()
    real(c_double) :: mass(cells), momentum(cells), force(cells), velocity(cells), volume, s
    integer        :: i, a, b

    mass = 0; momentum = 0; force = 0; volume = h/2
    do i = 1, particles
      s = x(i)/h - floor(x(i)/h); a = modulo(floor(x(i)/h), cells) + 1; b = modulo(a, cells) + 1
      mass([a, b]) = mass([a, b]) + [1 - s, s]*volume
      momentum([a, b]) = momentum([a, b]) + [1 - s, s]*volume*v(i)
      force([a, b]) = force([a, b]) + [1, -1]*volume*stress(i)/h
    end do
    velocity = (momentum + dt*force)/mass
    force = force/mass
    do i = 1, particles
      s = x(i)/h - floor(x(i)/h); a = modulo(floor(x(i)/h), cells) + 1; b = modulo(a, cells) + 1
      v(i) = v(i) + dt*((1 - s)*force(a) + s*force(b))
      stress(i) = stress(i) + dt*(velocity(b) - velocity(a))/h
      x(i) = x(i) + dt*((1 - s)*velocity(a) + s*velocity(b))
      x(i) = x(i) - floor(x(i))
    end do
  end subroutine
end module
