/* The bar as a plugin in C++: mpmstab spectrum -plugin ./libbar.so */
#include "bar.h"
#include <mpmstab_plugin.hpp>
#include <stdexcept>

struct Bar {
  static std::string describe()
  {
    return "{\"protocol\": 1, \"name\": \"bar\", \"dim\": 1, \"cell_width\": 0.0625, \"periodic\": [1.0], "
           "\"particles\": 32, "
           "\"fields\": [{\"name\": \"x\", \"size\": 1, \"place\": true}, {\"name\": \"v\", \"size\": 1, \"scale\": "
           "1}, "
           "{\"name\": \"stress\", \"size\": 1, \"scale\": 1}], \"parameters\": {\"dt\": 0.03125}, \"steps\": 1}";
  }

  static std::vector<double> base()
  {
    std::vector<double> state(3 * PARTICLES);

    start(0);
    memcpy(state.data(), p, sizeof p);
    return state;
  }

  static void set(const std::string &name, double value)
  {
    if (name != "dt") throw std::invalid_argument("there is only dt");
    dt = value;
  }

  static void step(double *state, std::size_t particles)
  {
    if (particles != PARTICLES) throw std::invalid_argument("there are 32 particles");
    memcpy(p, state, sizeof p);
    advance(dt);
    memcpy(state, p, sizeof p);
  }
};

MPMSTAB_PLUGIN(Bar)
