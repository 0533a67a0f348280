! The hook in Fortran. Compile the header once as C, and this module:
!
!   cc -x c -DMPMSTAB_PROBE_API= -c mpmstab_probe.h -o mpmstab_probe.o
!   gfortran -c mpmstab_hook.f90
!
!   type(mpmstab_loop) :: loop                                      loop%period = [Lx, Ly, Lz], 0 where none
!   call mpmstab_field(loop, 'x', x, place=.true.)                  x(n) or x(dim, n), real(8) or real(4), a target
!   call mpmstab_field(loop, 'v', v, scale=20d0)                    scale: what a change of order 1 means; may be absent
!   do while (.not. mpmstab_probe(loop, 'A.mtx', h))
!     call advance(dt)
!   end do
!
! Of an array of structures give a field of the first two particles, and the number of particles:
!
!   call mpmstab_field(loop, 'v', p(1)%v, p(2)%v, n)                real numbers or arrays in p, a target
!
! Compilers hand over p%v as a copy, or with a wrong address. So what is no target does not compile, and p%v is refused.
!
! mpmstab_probe.h says how it is done and what the comments in the file mean.
module mpmstab_hook
  use iso_c_binding
  use iso_fortran_env, only: error_unit
  implicit none
  private
  public :: mpmstab_loop, mpmstab_field, mpmstab_probe

  interface mpmstab_field
    module procedure double1, double2, float1, float2, double_in, doubles_in, float_in, floats_in
  end interface

  type, bind(c) :: mpmstab_loop
    real(c_double) :: period(3) = 0
    type(c_ptr)    :: work = c_null_ptr
  end type

  interface
    subroutine c_field(loop, name, first, kind, size, stride, particles, scale) bind(c, name='mpmstab_field')
      import
      type(mpmstab_loop)       :: loop
      type(c_ptr), value       :: name, first
      integer(c_int), value    :: kind, size
      integer(c_size_t), value :: stride
      integer(c_long), value   :: particles
      real(c_double), value    :: scale
    end subroutine
    subroutine c_place(loop, name, first, kind, size, stride, particles) bind(c, name='mpmstab_place')
      import
      type(mpmstab_loop)       :: loop
      type(c_ptr), value       :: name, first
      integer(c_int), value    :: kind, size
      integer(c_size_t), value :: stride
      integer(c_long), value   :: particles
    end subroutine
    integer(c_int) function c_probe(loop, path, h) bind(c, name='mpmstab_probe')
      import
      type(mpmstab_loop)                 :: loop
      character(kind=c_char), intent(in) :: path(*)
      real(c_double), value              :: h
    end function
  end interface

contains

  ! The bytes from one number to another.
  integer(c_intptr_t) function apart(one, other)
    type(c_ptr), intent(in) :: one, other
    apart = transfer(other, apart) - transfer(one, apart)
  end function

  subroutine refuse(name, why)
    character(*), intent(in) :: name, why
    write (error_unit, '(4a)') 'mpmstab_field: ', name, ': ', why
    stop 2
  end subroutine

  ! An array whose numbers do not follow one another is a part of structures.
  subroutine follow(name, one, other, bytes)
    character(*), intent(in) :: name
    type(c_ptr), intent(in)  :: one, other
    integer, intent(in)      :: bytes
    if (apart(one, other) /= bytes .and. apart(one, other) /= 0) &
      call refuse(name, 'it is a part of structures; needed: p(1)%'//name//', p(2)%'//name//' and the number of particles')
  end subroutine

  ! first, second: a number of the first two particles, which have size numbers one after another.
  subroutine register(loop, name, first, second, bytes, size, particles, scale, place)
    type(mpmstab_loop), intent(inout)    :: loop
    character(*), intent(in)             :: name
    type(c_ptr), intent(in)              :: first, second
    integer, intent(in)                  :: bytes, size, particles
    real(c_double), intent(in), optional :: scale
    logical, intent(in), optional        :: place
    character(kind=c_char), pointer      :: kept(:) ! C keeps its address
    integer                              :: i
    integer(c_size_t)                    :: stride
    real(c_double)                       :: of
    logical                              :: is_place

    stride = merge(int(bytes*size, c_intptr_t), apart(first, second), particles == 1)
    if (stride < bytes*size) &
      call refuse(name, 'the second particle does not come after the first; needed: p(1)%'//name//', p(2)%'//name)
    allocate (kept(len(name) + 1))
    do i = 1, len(name)
      kept(i) = name(i:i)
    end do
    kept(len(name) + 1) = c_null_char
    of = 0
    is_place = .false.
    if (present(scale)) of = scale
    if (present(place)) is_place = place
    if (is_place) then
      call c_place(loop, c_loc(kept), first, bytes, size, stride, int(particles, c_long))
    else
      call c_field(loop, c_loc(kept), first, bytes, size, stride, int(particles, c_long), of)
    end if
  end subroutine

  subroutine double1(loop, name, values, scale, place)
    type(mpmstab_loop), intent(inout)    :: loop
    character(*), intent(in)             :: name
    real(c_double), pointer, intent(in)  :: values(:)
    real(c_double), intent(in), optional :: scale
    logical, intent(in), optional        :: place
    call follow(name, c_loc(values(1)), c_loc(values(min(2, size(values)))), 8)
    call register(loop, name, c_loc(values(1)), c_loc(values(min(2, size(values)))), 8, 1, size(values), scale, place)
  end subroutine

  subroutine double2(loop, name, values, scale, place)
    type(mpmstab_loop), intent(inout)    :: loop
    character(*), intent(in)             :: name
    real(c_double), pointer, intent(in)  :: values(:, :)
    real(c_double), intent(in), optional :: scale
    logical, intent(in), optional        :: place
    call follow(name, c_loc(values(1, 1)), c_loc(values(min(2, size(values, 1)), 1)), 8)
    call register(loop, name, c_loc(values(1, 1)), c_loc(values(1, min(2, size(values, 2)))), 8, size(values, 1), &
                  size(values, 2), scale, place)
  end subroutine

  subroutine double_in(loop, name, first, second, particles, scale, place)
    type(mpmstab_loop), intent(inout)    :: loop
    character(*), intent(in)             :: name
    real(c_double), pointer, intent(in)  :: first, second
    integer, intent(in)                  :: particles
    real(c_double), intent(in), optional :: scale
    logical, intent(in), optional        :: place
    call register(loop, name, c_loc(first), c_loc(second), 8, 1, particles, scale, place)
  end subroutine

  subroutine doubles_in(loop, name, first, second, particles, scale, place)
    type(mpmstab_loop), intent(inout)    :: loop
    character(*), intent(in)             :: name
    real(c_double), pointer, intent(in)  :: first(:), second(:)
    integer, intent(in)                  :: particles
    real(c_double), intent(in), optional :: scale
    logical, intent(in), optional        :: place
    call register(loop, name, c_loc(first(1)), c_loc(second(1)), 8, size(first), particles, scale, place)
  end subroutine

  subroutine float1(loop, name, values, scale, place)
    type(mpmstab_loop), intent(inout)    :: loop
    character(*), intent(in)             :: name
    real(c_float), pointer, intent(in)  :: values(:)
    real(c_double), intent(in), optional :: scale
    logical, intent(in), optional        :: place
    call follow(name, c_loc(values(1)), c_loc(values(min(2, size(values)))), 4)
    call register(loop, name, c_loc(values(1)), c_loc(values(min(2, size(values)))), 4, 1, size(values), scale, place)
  end subroutine

  subroutine float2(loop, name, values, scale, place)
    type(mpmstab_loop), intent(inout)    :: loop
    character(*), intent(in)             :: name
    real(c_float), pointer, intent(in)  :: values(:, :)
    real(c_double), intent(in), optional :: scale
    logical, intent(in), optional        :: place
    call follow(name, c_loc(values(1, 1)), c_loc(values(min(2, size(values, 1)), 1)), 4)
    call register(loop, name, c_loc(values(1, 1)), c_loc(values(1, min(2, size(values, 2)))), 4, size(values, 1), &
                  size(values, 2), scale, place)
  end subroutine

  subroutine float_in(loop, name, first, second, particles, scale, place)
    type(mpmstab_loop), intent(inout)    :: loop
    character(*), intent(in)             :: name
    real(c_float), pointer, intent(in)  :: first, second
    integer, intent(in)                  :: particles
    real(c_double), intent(in), optional :: scale
    logical, intent(in), optional        :: place
    call register(loop, name, c_loc(first), c_loc(second), 4, 1, particles, scale, place)
  end subroutine

  subroutine floats_in(loop, name, first, second, particles, scale, place)
    type(mpmstab_loop), intent(inout)    :: loop
    character(*), intent(in)             :: name
    real(c_float), pointer, intent(in)  :: first(:), second(:)
    integer, intent(in)                  :: particles
    real(c_double), intent(in), optional :: scale
    logical, intent(in), optional        :: place
    call register(loop, name, c_loc(first(1)), c_loc(second(1)), 4, size(first), particles, scale, place)
  end subroutine

  logical function mpmstab_probe(loop, path, h)
    type(mpmstab_loop), intent(inout) :: loop
    character(*), intent(in)          :: path
    real(c_double), intent(in)        :: h
    mpmstab_probe = c_probe(loop, trim(path)//c_null_char, h) /= 0
  end function
end module
