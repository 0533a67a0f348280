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
! mpmstab_probe.h says how it is done and what the comments in the file mean.
module mpmstab_hook
  use iso_c_binding
  implicit none
  private
  public :: mpmstab_loop, mpmstab_field, mpmstab_probe

  interface mpmstab_field
    module procedure double1, double2, float1, float2
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

    ! The first index runs over the numbers of a particle, the last over particles.
  subroutine register(loop, name, first, bytes, extents, scale, place)
    type(mpmstab_loop), intent(inout)    :: loop
    character(*), intent(in)             :: name
    type(c_ptr), intent(in)              :: first
    integer, intent(in)                  :: bytes, extents(:)
    real(c_double), intent(in), optional :: scale
    logical, intent(in), optional        :: place
    character(kind=c_char), pointer      :: kept(:) ! C keeps its address
    integer                              :: i, width
    integer(c_long)                      :: n
    real(c_double)                       :: of
    logical                              :: is_place

    allocate (kept(len(name) + 1))
    do i = 1, len(name)
      kept(i) = name(i:i)
    end do
    kept(len(name) + 1) = c_null_char
    n = extents(size(extents))
    width = product(extents(:size(extents) - 1))
    of = 0
    is_place = .false.
    if (present(scale)) of = scale
    if (present(place)) is_place = place
    if (is_place) then
      call c_place(loop, c_loc(kept), first, bytes, width, int(width*bytes, c_size_t), n)
    else
      call c_field(loop, c_loc(kept), first, bytes, width, int(width*bytes, c_size_t), n, of)
    end if
  end subroutine

  subroutine double1(loop, name, values, scale, place)
    type(mpmstab_loop), intent(inout)            :: loop
    character(*), intent(in)                     :: name
    real(c_double), intent(in), target, contiguous :: values(:)
    real(c_double), intent(in), optional         :: scale
    logical, intent(in), optional                :: place
    call register(loop, name, c_loc(values), 8, shape(values), scale, place)
  end subroutine

  subroutine double2(loop, name, values, scale, place)
    type(mpmstab_loop), intent(inout)            :: loop
    character(*), intent(in)                     :: name
    real(c_double), intent(in), target, contiguous :: values(:, :)
    real(c_double), intent(in), optional         :: scale
    logical, intent(in), optional                :: place
    call register(loop, name, c_loc(values), 8, shape(values), scale, place)
  end subroutine

  subroutine float1(loop, name, values, scale, place)
    type(mpmstab_loop), intent(inout)            :: loop
    character(*), intent(in)                     :: name
    real(c_float), intent(in), target, contiguous :: values(:)
    real(c_double), intent(in), optional         :: scale
    logical, intent(in), optional                :: place
    call register(loop, name, c_loc(values), 4, shape(values), scale, place)
  end subroutine

  subroutine float2(loop, name, values, scale, place)
    type(mpmstab_loop), intent(inout)            :: loop
    character(*), intent(in)                     :: name
    real(c_float), intent(in), target, contiguous :: values(:, :)
    real(c_double), intent(in), optional         :: scale
    logical, intent(in), optional                :: place
    call register(loop, name, c_loc(values), 4, shape(values), scale, place)
  end subroutine

  logical function mpmstab_probe(loop, path, h)
    type(mpmstab_loop), intent(inout) :: loop
    character(*), intent(in)          :: path
    real(c_double), intent(in)        :: h
    mpmstab_probe = c_probe(loop, trim(path)//c_null_char, h) /= 0
  end function
end module
