/*
   mls-mpm88-explained.cpp as a plugin for mpmstab:

     git clone https://github.com/yuanming-hu/taichi_mpm
     c++ -O2 -fPIC -shared -I../../include -Itaichi_mpm -Itaichi -o libexplained.so explained.cpp
     mpmstab critical -plugin ./libexplained.so

   Their file is included as it is; only its main gets another name. The base state is a square of SIDE x SIDE particles at
   rest, 2 x 2 a cell, in the middle of their grid, away from its walls: 20 x 20, or with -DSIDE=1 a lone particle. Gravity
   moves all particles alike. It is taken off again after each step, so that what is at rest stays at rest.
*/
#include <stdio.h>
#define main their_main
#include "mls-mpm88-explained.cpp"
#undef main
#include <mpmstab_plugin.hpp>

#ifndef SIDE
#define SIDE 20
#endif

struct Explained {
  /* Scales are a tenth of what a strain of 1 means, since snow yields at a strain of 0.0075. */
  static std::string describe()
  {
    const double wave_speed = std::sqrt((lambda_0 + 2 * mu_0) * vol / particle_mass);
    char         text[512];

    snprintf(text, sizeof text,
             "{\"protocol\": 1, \"name\": \"mls-mpm88-explained\", \"dim\": 2, \"cell_width\": %.9g, "
             "\"parameters\": {\"dt\": %.9g}, \"particles\": %d, \"fields\": ["
             "{\"name\": \"x\", \"size\": 2, \"place\": true}, "
             "{\"name\": \"v\", \"size\": 2, \"scale\": %g}, {\"name\": \"F\", \"size\": 4, \"scale\": 0.1}, "
             "{\"name\": \"C\", \"size\": 4, \"scale\": %g}, {\"name\": \"Jp\", \"size\": 1, \"scale\": 0.1}]}",
             dx, dt, SIDE * SIDE, 0.1 * wave_speed, 0.1 * wave_speed / dx);
    return text;
  }

  /* The numbers of a particle, in the order that is described. */
  static std::vector<real *> numbers(Particle &p)
  {
    return {&p.x[0],    &p.x[1],    &p.v[0],    &p.v[1],    &p.F[0][0], &p.F[0][1], &p.F[1][0],
            &p.F[1][1], &p.C[0][0], &p.C[0][1], &p.C[1][0], &p.C[1][1], &p.Jp};
  }

  static std::vector<double> base()
  {
    std::vector<double> state;

    for (int i = 0; i < SIDE * SIDE; i++) {
      Particle p(Vec(35.25f + 0.5f * (i % SIDE), 35.25f + 0.5f * (i / SIDE)) * dx, 0);

      for (const real *number : numbers(p)) state.push_back(*number);
    }
    return state;
  }

  static real &time_step()
  {
    static real now = dt;
    return now;
  }

  static void set(const std::string &, double value)
  {
    time_step() = (real)value;
  }

  static void step(double *state, std::size_t n)
  {
    const real fallen = -200.0f * time_step();
    double    *number = state;

    particles.assign(n, Particle(Vec(0), 0));
    for (Particle &p : particles)
      for (real *of : numbers(p)) *of = (real)*number++;
    advance(time_step());
    number = state;
    for (Particle &p : particles) {
      p.v[1] -= fallen;
      p.x[1] -= fallen * time_step();
      for (const real *of : numbers(p)) *number++ = *of;
    }
  }
};

MPMSTAB_PLUGIN(Explained)
