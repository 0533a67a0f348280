# find_package(mpmstab): the target mpmstab::mpmstab, which is what mpmstab.pc says: its flags in their order, because
# libmpmstab.a stands before the libraries that it needs.
include(CMakeFindDependencyMacro)
find_dependency(PkgConfig)
set(pkg_config_path "$ENV{PKG_CONFIG_PATH}")
set(ENV{PKG_CONFIG_PATH} "${CMAKE_CURRENT_LIST_DIR}/../../pkgconfig:${pkg_config_path}")
pkg_check_modules(mpmstab_pc REQUIRED mpmstab)
set(ENV{PKG_CONFIG_PATH} "${pkg_config_path}")
if(NOT TARGET mpmstab::mpmstab)
  add_library(mpmstab::mpmstab INTERFACE IMPORTED)
  target_include_directories(mpmstab::mpmstab INTERFACE ${mpmstab_pc_INCLUDE_DIRS})
  target_link_libraries(mpmstab::mpmstab INTERFACE ${mpmstab_pc_LDFLAGS})
endif()
