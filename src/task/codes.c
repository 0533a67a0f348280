/*
   The table of public codes. Each line says what was read in the file that it names, at the commit of its code. What was
   not read is not here.
*/
#include "task/codes.h"
#include <stddef.h>

/* MLS-MPM (Hu et al. 2018) as one after another has taken it over; the stress at its P2G is that of the last G2P. */
#define MLS_MPM "-formulation usl -transfer apic -gradient mls -basis quadratic"
#define MLS_MPM_LIMIT "1.30637"

#define OPTIONS(...)                                                                                                   \
  (const MpmCodeOption[])                                                                                              \
  {                                                                                                                    \
    __VA_ARGS__,                                                                                                       \
    {                                                                                                                  \
      NULL, NULL, NULL                                                                                                 \
    }                                                                                                                  \
  }

/* Codes of engineering, then those of graphics, each by name. */
/* clang-format off */
const MpmCode MpmCodes[] = {
    {"Anura3D", "Anura3D/Anura3D_OpenSource", "016e9d0", NULL, NULL, OPTIONS(
        {"MPM, one phase", "-formulation musl -transfer flip", "src/MPMDYNConvPhase.FOR"},
        {"mixed integration", "none: stresses are averaged in full elements", "src/MPMDYNConvPhase.FOR"},
        {"elements", "not read", "src/MPMDYNConvPhase.FOR"})},
    {"CB-Geo", "cb-geo/mpm", "53fcb760 of 2022-10-12", "-formulation usf -transfer flip -basis linear", "1.73205", OPTIONS(
        {"\"mpm_scheme\": \"usl\"", "-formulation usl", "include/solvers/mpm_explicit.tcc"},
        {"\"mpm_scheme\": anything else, or none", "-formulation usf", "include/solvers/mpm_explicit.tcc"},
        {"\"velocity_update\": false, the default", "-transfer flip", "include/particles/particle.tcc"},
        {"\"velocity_update\": true", "-transfer pic", "include/particles/particle.tcc"},
        {"ED2Q4, ED3H8", "-basis linear", "src/element.cc"},
        {"ED2Q16G, ED3H64G", "-basis gimp", "src/element.cc"},
        {"ED2T3, ED2T6, ED2Q8, ED2Q9, ED3H20", "none: other elements", "src/element.cc"},
        {"\"dt\"", "the user's", "include/solvers/mpm_base.tcc"})},
    {"geomechanics/mpm, after CB-Geo", "geomechanics/mpm", "4044dbe8 of 2026-05-01", "-formulation usf -transfer flip -basis linear", "1.73205", OPTIONS(
        {"\"mpm_scheme\": \"usl\"", "-formulation usl", "include/solvers/mpm_explicit.tcc"},
        {"\"mpm_scheme\": \"musl\"", "-formulation musl", "include/solvers/mpm_explicit.tcc"},
        {"\"mpm_scheme\": anything else, or none", "-formulation usf", "include/solvers/mpm_explicit.tcc"},
        {"\"velocity_update\": \"flip\", the default", "-transfer flip", "include/particles/particle.tcc"},
        {"the same with \"blending_ratio\": a", "-transfer blend -blend_ratio a", "include/particles/particle.tcc"},
        {"\"velocity_update\": \"pic\"", "-transfer pic", "include/particles/particle.tcc"},
        {"\"velocity_update\": \"apic\"", "-transfer apic -gradient basis", "include/particles/particle.tcc"},
        {"\"velocity_update\": \"tpic\", \"asflip\"", "none", "include/particles/particle.tcc"},
        {"ED2Q4, ED3H8; ED2Q16G, ED3H64G", "-basis linear; -basis gimp", "src/element.cc"},
        {"ED2Q4P2B, ED3H8P2B", "-basis quadratic, with other knots at ends", "src/element.cc"},
        {"other elements; implicit; two phases", "none, or not read", "src/element.cc"})},
    {"GeoTaichi", "Yihao-Shi/GeoTaichi", "8e22a64 of 2026-06-27", "-formulation musl -transfer flip -basis linear", "1.73205", OPTIONS(
        {"mapping \"MUSL\", the default", "-formulation musl", "src/mpm/engines/ULExplicitEngine.py"},
        {"mapping \"USL\"", "-formulation usl", "src/mpm/engines/ULExplicitEngine.py"},
        {"mapping \"USF\"", "-formulation usf", "src/mpm/engines/ULExplicitEngine.py"},
        {"velocity_projection \"Affine\"", "none, with any mapping: usl, strains by mls, forces by the basis", "src/mpm/engines/ULExplicitEngine.py"},
        {"alphaPIC 0, the default", "-transfer flip", "src/mpm/structs/Particle.py"},
        {"alphaPIC a", "-transfer blend -blend_ratio 1-a", "src/mpm/structs/Particle.py"},
        {"velocity_projection \"Taylor\"", "none: P2G takes v + grad v (x_i - x_p)", "src/mpm/engines/EngineKernel.py"},
        {"moving_least_square, QuadBSpline, 3-D", MLS_MPM, "src/mpm/elements/HexahedronElement8Nodes.py"},
        {"moving_least_square, 2-D", "none: forces have 4 / h where strains have 4 / h^2", "src/mpm/elements/QuadrilateralElement4Nodes.py"},
        {"velocity_projection \"PIC\"", "-transfer pic", "src/mpm/Simulation.py"},
        {"Linear, the default; GIMP", "-basis linear; -basis gimp", "src/mpm/Simulation.py"},
        {"QuadBSpline; CubicBSpline", "-basis quadratic; -basis cubic", "src/mpm/Simulation.py"},
        {"Lightweight, G2P2G, Implicit", "not read", "src/mpm/Simulation.py"})},
    {"Karamelo", "adevaucorbeil/karamelo", "08e444d of 2025-04-01", "-formulation musl -transfer blend -blend_ratio 0.99 -basis linear", "1.72988", OPTIONS(
        {"scheme(musl), the default", "-formulation musl", "src/musl.cpp"},
        {"scheme(usl)", "-formulation usl", "src/usl.cpp"},
        {"scheme(usf)", "-formulation usf", "src/usf.cpp"},
        {"method(ulmpm, PIC, ...)", "-transfer pic", "src/update.cpp"},
        {"method(ulmpm, FLIP, ..., a), 0.99 at first", "-transfer blend -blend_ratio a; -transfer flip for 1", "src/update.cpp"},
        {"linear, the default", "-basis linear", "src/update.cpp"},
        {"quadratic-spline, cubic-spline", "-basis quadratic, -basis cubic; -spline_ends modified", "src/basis_functions.h"},
        {"scheme(usl), method(ulmpm, MLS, ...)", "-formulation usl -transfer apic -gradient mls", "src/ulmpm.cpp"},
        {"scheme(usl), method(ulmpm, APIC, ...)", "none: strains by mls, forces by the basis", "src/ulmpm.cpp"},
        {"scheme(musl or usf), APIC or MLS", "none: P2G takes the affine field of an older velocity", "src/ulmpm.cpp"},
        {"AFLIP, ASFLIP", "none: aflip, but strains by mls, forces by the basis", "src/ulmpm.cpp"},
        {"method(tlmpm, ...)", "-drift 0: particles keep their places", "src/tlmpm.cpp"},
        {"dt_factor(0.9), the default", "dt = 0.9 h / (c + the fastest particle)", "src/solid.cpp"})},
    {"MaterialPointSolver.jl", "LandslideSIM/MaterialPointSolver.jl", "d6c436d of 2024-10-20", "-formulation musl -transfer flip -basis gimp", "1.73205", OPTIONS(
        {"scheme=:MUSL, the default", "-formulation musl", "src/solvers/OS_MUSL.jl"},
        {"scheme=:USL", "-formulation usl", "src/solvers/OS_USL.jl"},
        {"scheme=:USF", "-formulation usl: strains from the last new nodal velocity", "src/solvers/OS_USF.jl"},
        {"FLIP=1, PIC=0, the default", "-transfer flip", "src/solvers/utils_OS.jl"},
        {"FLIP=a, PIC=1-a", "-transfer blend -blend_ratio a", "src/solvers/utils_OS.jl"},
        {"basis=:uGIMP, the default", "-basis gimp", "src/types/modelargs.jl"},
        {"basis=:linear", "-basis linear", "src/types/modelargs.jl"})},
    {"matter", "larsblatny/matter", "bf948b6 of 2026-05-04", "-formulation usl -transfer aflip -aflip_ratio 0.95 -basis quadratic", "1.6285", OPTIONS(
        {"use_musl false, the default", "-formulation usl", "src/simulation/simulation.cpp"},
        {"use_musl true", "-formulation musl", "src/simulation/simulation.cpp"},
        {"cfl_elastic 0.5, the default", "dt = 0.5 h / c, and no more than 0.5 h / the fastest particle", "src/simulation/simulation.cpp"},
        {"flip_ratio a from 0 to 1", "-transfer blend -blend_ratio a; flip for 1, pic for 0", "src/simulation/position_update.cpp"},
        {"flip_ratio below -1", "-transfer apic", "src/simulation/position_update.cpp"},
        {"flip_ratio -a from -1 to 0; -0.95 by default", "-transfer aflip -aflip_ratio a", "src/simulation/position_update.cpp"},
        {"SPLINEDEG 2, the default; 1; 3", "-basis quadratic; -basis linear; -basis cubic", "src/tools.hpp"})},
    {"MPM-Geomechanics", "fabricix/MPM-Geomechanics", "3911104 of 2026-07-28", "-formulation usl -transfer flip -basis gimp", "0.755929", OPTIONS(
        {"\"stress_scheme_update\": \"USL\", the default", "-formulation usl", "src/SolverExplicit.cpp"},
        {"\"stress_scheme_update\": \"MUSL\"", "-formulation musl", "src/SolverExplicit.cpp"},
        {"always", "-transfer flip", "src/Update.cpp"},
        {"\"shape_function\": \"GIMP\", the default", "-basis gimp", "src/Input.cpp"},
        {"\"shape_function\": \"linear\"", "-basis linear", "src/Input.cpp"},
        {"\"critical_time_step_multiplier\": 0.25", "dt = 0.25 h / c, the default; warns of a user's dt above h / c", "src/MPM.cpp"})},
    {"MPM3D-F90", "xzhang66/MPM3D-F90", "4a6275f of 2025-11-19", "-formulation musl -transfer flip -basis linear", "1.73205", OPTIONS(
        {"musl, the default", "-formulation musl", "src/MPM3D.f90"},
        {"usl", "-formulation usl", "src/MPM3D.f90"},
        {"usf", "-formulation usf", "src/MPM3D.f90"},
        {"always", "-transfer flip", "src/update_step.f90"},
        {"dtsc 0.9, the default", "dt = 0.9 h / (c + the fastest particle)", "src/update_step.f90"},
        {"neither; gimp; bimp", "-basis linear; -basis gimp; -basis quadratic", "src/DataIn.f90"},
        {"sgmp", "none: two grids", "src/DataIn.f90"},
        {"bq1 1.5, bq2 0.06, the defaults", "none: bulk viscosity in compression, of elastic materials too", "src/Material.f90"},
        {"with these, measured", "none: limits of some 1.70 for musl and usf, some 0.74 for usl", "src/Material.f90"})},
    {"mpmat", "vinhphunguyen/mpmat", "086bb39 of 2023-04-18", "-formulation usl -transfer flip -basis linear", "0.755929", OPTIONS(
        {"doubleMapping = 0, as it is", "-formulation usl -basis linear", "example1D/mpm1DVibrationBar.m"},
        {"doubleMapping = 1", "-formulation musl -basis linear", "example1D/mpm1DVibrationBar.m"},
        {"alpha = 1, as it is; a", "-transfer flip; -transfer blend -blend_ratio a", "example1D/mpm1DVibrationBar.m"},
        {"dtime", "dt = 0.2 h / c", "example1D/mpm1DVibrationBar.m"},
        {"gimp1DVibrationBar", "-formulation usl -transfer flip -basis gimp", "example1D/gimp1DVibrationBar.m"},
        {"mpm1DVibrationBarUSLDoubleMap", "-formulation musl -transfer flip -basis linear", "example1D/mpm1DVibrationBarUSLDoubleMap.m"},
        {"mpm1DUSF", "-formulation usf -transfer flip -basis linear", "example1D/mpm1DUSF.m"})},
    {"NairnMPM", "nairnj/nairn-mpm-fea", "7f47b022 of 2026-04-01", "-formulation usavg -transfer flip -basis linear", "1.73205", OPTIONS(
        {"MPMMethod 2 (USAVG), the default", "-formulation usavg", "NairnMPM/src/NairnMPM_Class/NairnMPM.cpp"},
        {"MPMMethod 0 (USF)", "-formulation usf", "NairnMPM/src/NairnMPM_Class/NairnMPM.cpp"},
        {"MPMMethod 3 (USL)", "-formulation musl: it extrapolates again", "NairnMPM/src/NairnMPM_Class/NairnMPM.cpp"},
        {"MPMMethod 3, SkipPostExtrapolation", "-formulation usl; refused with Classic", "NairnMPM/src/NairnMPM_Class/NairnMPM.cpp"},
        {"MPMMethod 2, SkipPostExtrapolation", "none: the second half is from the new nodal velocity", "NairnMPM/src/NairnMPM_Class/NairnMPM.cpp"},
        {"TimeStep CFL 0.5, the default", "dt = 0.5 h / c", "NairnMPM/src/NairnMPM_Class/NairnMPM.cpp"},
        {"no PeriodicXPIC, the default", "-transfer flip", "NairnMPM/src/Global_Quantities/BodyForce.cpp"},
        {"PeriodicXPIC: XPICOrder k, periodicSteps 1", "-transfer xpic -xpic_order k; 1 is pic", "NairnMPM/src/Custom_Tasks/PeriodicXPIC.cpp"},
        {"PeriodicXPIC: periodicSteps above 1", "none: xpic or fmpm in some steps, flip in the others", "NairnMPM/src/Custom_Tasks/PeriodicXPIC.cpp"},
        {"PeriodicXPIC: FMPMOrder k, periodicSteps 1", "-transfer fmpm -xpic_order k; 1 is pic", "NairnMPM/src/NairnMPM_Class/UpdateStrainsFirstTask.cpp"},
        {"GIMP type Classic, and without GIMP", "-basis linear", "NairnMPM/src/Read_MPM/MPMReadHandler.cpp"},
        {"GIMP type uGIMP; B2SPLINE", "-basis gimp; -basis quadratic", "NairnMPM/src/Read_MPM/MPMReadHandler.cpp"},
        {"lCPDI, qCPDI, Finite, B2GIMP, B2CPDI", "none", "NairnMPM/src/Read_MPM/MPMReadHandler.cpp"})},
    {"Uintah", "Uintah/Uintah", "d4508b2337 of 2026-07-28", "-formulation usl -transfer flip -basis linear", "0.755929", OPTIONS(
        {"time_integrator explicit, the default", "-formulation usl", "src/CCA/Components/MPM/SerialMPM.cc"},
        {"XPIC2 false, the default", "-transfer flip", "src/CCA/Components/MPM/SerialMPM.cc"},
        {"XPIC2 true", "-transfer xpic -xpic_order 2", "src/CCA/Components/MPM/SerialMPM.cc"},
        {"time_integrator implicit, fracture; AMR", "not read", "src/CCA/Components/MPM/Core/MPMFlags.cc"},
        {"interpolator linear, the default; gimp", "-basis linear; -basis gimp", "src/CCA/Components/MPM/Core/MPMFlags.cc"},
        {"cpdi, fast_cpdi, cpti", "none", "src/CCA/Components/MPM/Core/MPMFlags.cc"},
        {"interpolator 3rdorderBS", "-basis quadratic", "src/Core/Grid/TOBSplineInterpolator.cc"},
        {"interpolator 4thorderBS", "-basis cubic", "src/Core/Grid/BSplineInterpolator.cc"},
        {"timestep_multiplier, no default", "a factor of the material's step", "src/CCA/Components/Application/ApplicationCommon.cc"},
        {"dt of a material", "h / (c + the fastest particle)", "src/CCA/Components/MPM/Materials/ConstitutiveModel/HypoElastic.cc"},
        {"one_d_mpm_new", "-formulation usf -transfer flip -basis linear -boundary fixed_reaction", "src/CCA/Components/MPM/Matlab/one_d_mpm_new.m"})},
    {"claymore", "penn-graphics-research/claymore", "3b19462 of 2023-05-22", MLS_MPM, MLS_MPM_LIMIT, OPTIONS(
        {"always (GMPM)", MLS_MPM, "Projects/GMPM/mgmpm_kernels.cuh"},
        {"dt", "the scene's, and no more than 0.5 h / the fastest node; c does not enter", "Projects/GMPM/utility_funcs.hpp"})},
    {"DiffTaichi", "taichi-dev/difftaichi", "9f4ee52 of 2023-11-01", MLS_MPM, MLS_MPM_LIMIT, OPTIONS(
        {"solids; dt = 1e-3", MLS_MPM "; c dt / h = 0.701", "examples/diffmpm.py"},
        {"solids; dt = 2e-3", MLS_MPM "; c dt / h = 0.701", "examples/diffmpm3d.py"})},
    {"FluidLab", "zhouxian/FluidLab", "7295eb6 of 2023-12-15", MLS_MPM, MLS_MPM_LIMIT, OPTIONS(
        {"always, away from rigid bodies", MLS_MPM, "fluidlab/fluidengine/simulators/mpm_simulator.py"},
        {"dt", "2e-4, whatever c", "fluidlab/fluidengine/simulators/mpm_simulator.py"})},
    {"Genesis", "Genesis-Embodied-AI/Genesis", "7bf5f6a7 of 2026-04-05", MLS_MPM, MLS_MPM_LIMIT, OPTIONS(
        {"always, away from rigid bodies", MLS_MPM, "genesis/engine/solvers/mpm_solver.py"},
        {"dt", "the user's; warns above 0.02 h (in s and m), whatever c", "genesis/engine/solvers/mpm_solver.py"})},
    {"incremental_mpm", "nialltl/incremental_mpm", "2c46592 of 2019-04-29", MLS_MPM, MLS_MPM_LIMIT, OPTIONS(
        {"2. MLS_MPM_NeoHookean", MLS_MPM, "Assets/2. MLS_MPM_NeoHookean_Multithreaded/MLS_MPM_NeoHookean_Multithreaded.cs"},
        {"3. MLS_MPM_Fluid", "none: pressure from the mass of the nodes, not from strains", "Assets/3. MLS_MPM_Fluid_Multithreaded/MLS_MPM_Fluid_Multithreaded.cs"})},
    {"NCLaw", "PingchuanMa/NCLaw", "ff4e27a of 2023-06-28", MLS_MPM, MLS_MPM_LIMIT, OPTIONS(
        {"always; the stress may be a network's", MLS_MPM, "nclaw/sim/mpm.py"})},
    {"Newton", "newton-physics/newton", "41a5392c1 of 2026-08-22", NULL, NULL, OPTIONS(
        {"SolverImplicitMPM", "none: implicit", "newton/_src/solvers/implicit_mpm/solver_implicit_mpm.py"})},
    {"NVIDIA Warp", "NVIDIA/warp", "9934a4eb2 of 2026-08-22", NULL, NULL, OPTIONS(
        {"example_apic_fluid", "none: incompressible, a pressure solved for in each step", "warp/examples/fem/example_apic_fluid.py"})},
    {"PhysDreamer", "a1600012888/PhysDreamer", "95beb71 of 2025-02-10", "-formulation usl -transfer apic -gradient basis -basis quadratic", "1.64777", OPTIONS(
        {"always", "-formulation usl -gradient basis -basis quadratic", "physdreamer/warp_mpm/mpm_utils.py"},
        {"rpic_damping 0, the default", "-transfer apic", "physdreamer/warp_mpm/mpm_utils.py"},
        {"rpic_damping -1", "-transfer pic", "physdreamer/warp_mpm/mpm_utils.py"})},
    {"PhysGaussian", "XPandora/PhysGaussian", "8339ed6 of 2025-04-06", "-formulation usl -transfer apic -gradient basis -basis quadratic", "1.64777", OPTIONS(
        {"always", "-formulation usl -gradient basis -basis quadratic", "mpm_solver_warp/mpm_utils.py"},
        {"rpic_damping 0, the default", "-transfer apic", "mpm_solver_warp/mpm_utils.py"},
        {"rpic_damping -1", "-transfer pic", "mpm_solver_warp/mpm_utils.py"},
        {"rpic_damping from 0 to 1", "none: part of the symmetric affine field is taken away", "mpm_solver_warp/mpm_utils.py"},
        {"grid_v_damping_scale below 1", "none: damps nodal velocities", "mpm_solver_warp/mpm_solver_warp.py"})},
    {"PlasticineLab", "hzaskywalker/PlasticineLab", "ac1a2f7 of 2021-03-10", MLS_MPM, MLS_MPM_LIMIT, OPTIONS(
        {"always", MLS_MPM, "plb/engine/mpm_simulator.py"})},
    {"sparkl", "dimforge/sparkl", "29cebe6 of 2024-07-29", MLS_MPM, MLS_MPM_LIMIT, OPTIONS(
        {"solids", MLS_MPM, "src/dynamics/solver/particle_to_grid.rs"},
        {"alpha", "dt = alpha h / the larger of c and the particle's speed", "src_core/dynamics/timestep/elasticity_sound_speed_timestep_bound.rs"})},
    {"squishy_volumes", "Algebraic-UG/squishy_volumes", "cbc06d2 of 2026-08-20", MLS_MPM, MLS_MPM_LIMIT, OPTIONS(
        {"always (CPU)", MLS_MPM, "rust/crates/cpu/src/phase/scatter_momentum.rs"},
        {"dt", "at most h / c, 0.5 h / the fastest particle, and a bound for lone particles", "rust/crates/cpu/src/phase/limit_time_step.rs"})},
    {"Taichi, examples", "taichi-dev/taichi", "ba0e81dce5 of 2025-07-30", MLS_MPM, MLS_MPM_LIMIT, OPTIONS(
        {"mpm88: a fluid, dt = 2e-4", MLS_MPM "; c dt / h = 0.512", "python/taichi/examples/simulation/mpm88.py"},
        {"mpm99: jelly, dt = 1e-4", MLS_MPM "; c dt / h = 0.234", "python/taichi/examples/simulation/mpm99.py"},
        {"mpm128: jelly, dt = 1e-4", MLS_MPM "; c dt / h = 0.523", "python/taichi/examples/simulation/mpm128.py"},
        {"mpm3d: a fluid, dt = 4e-4", MLS_MPM "; c dt / h = 0.256", "python/taichi/examples/simulation/mpm3d.py"},
        {"mpm3d_ggui", MLS_MPM, "python/taichi/examples/ggui_examples/mpm3d_ggui.py"},
        {"mpm_lagrangian_forces", "none: forces of a mesh of triangles", "python/taichi/examples/simulation/mpm_lagrangian_forces.py"})},
    {"taichi_elements", "taichi-dev/taichi_elements", "2451c98 of 2023-02-09", MLS_MPM, MLS_MPM_LIMIT, OPTIONS(
        {"always, with use_g2p2g too", MLS_MPM, "engine/mpm_solver.py"},
        {"default_dt", "0.02 h / size dt_scale; elastic, size 1, scales 1: c dt / h = 0.365", "engine/mpm_solver.py"})},
    {"taichi_mpm", "yuanming-hu/taichi_mpm", "3a680ab of 2022-02-23", MLS_MPM, MLS_MPM_LIMIT, OPTIONS(
        {"mls-mpm88-explained: dt = 1e-4", MLS_MPM "; c dt / h = 0.843 at first", "mls-mpm88-explained.cpp"},
        {"with MLSMPM, a macro that is defined", MLS_MPM, "src/transfer.cpp"},
        {"without", "-formulation usl -transfer apic -gradient basis -basis quadratic", "src/transfer.cpp"})},
    {"warp-mpm", "zeshunzong/warp-mpm", "4ce96dc of 2024-08-13", "-formulation usl -transfer apic -gradient basis -basis quadratic", "1.64777", OPTIONS(
        {"always", "-formulation usl -gradient basis -basis quadratic", "mpm_utils.py"},
        {"rpic_damping 0, the default", "-transfer apic", "mpm_utils.py"},
        {"rpic_damping -1", "-transfer pic", "mpm_utils.py"},
        {"rpic_damping from 0 to 1", "none: part of the symmetric affine field is taken away", "mpm_utils.py"},
        {"grid_v_damping_scale below 1", "none: damps nodal velocities", "mpm_solver_warp.py"})},
    {"wgsparkl", "dimforge/wgsparkl", "d857579 of 2025-04-07", MLS_MPM, MLS_MPM_LIMIT, OPTIONS(
        {"solids", MLS_MPM, "src/solver/particle_update.wgsl"},
        {"dt", "the user's; particles move by a cell at most", "src/solver/particle_update.wgsl"})},
    {NULL, NULL, NULL, NULL, NULL, NULL}};
/* clang-format on */
