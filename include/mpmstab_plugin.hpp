/*
   mpmstab_plugin.hpp: a plugin for mpmstab in C++. Give the code as a class, and name it once in one file:

     struct Mine {
       static std::string describe();                       the description of <mpmstab/plugin.h>, in JSON
       static std::vector<double> base();                   the base state, particle by particle
       static void set(const std::string &name, double value);
       static void step(double *state, std::size_t particles);
     };
     MPMSTAB_PLUGIN(Mine)

   It is built as a shared library: c++ -fPIC -shared -o libmine.so mine.cpp. What set and step throw is their error.
*/
#pragma once
#include <cstddef>
#include <exception>
#include <string>
#include <vector>
#include <mpmstab/plugin.h>

namespace mpmstab
{
inline std::string &wrong()
{
  static std::string text;
  return text;
}

/* Does what it is given; 1 and a text when that throws. */
template <class Action> int caught(Action action)
{
  try {
    action();
    return 0;
  } catch (const std::exception &e) {
    wrong() = e.what();
  } catch (...) {
    wrong() = "an exception that is no std::exception";
  }
  return 1;
}
} // namespace mpmstab

#define MPMSTAB_PLUGIN(Code)                                                                                           \
  const char *mpmstab_describe(const double **state)                                                                   \
  {                                                                                                                    \
    static std::vector<double> base;                                                                                   \
    static std::string         text;                                                                                   \
    if (mpmstab::caught([] { text = Code::describe(), base = Code::base(); })) return nullptr;                         \
    *state = base.data();                                                                                              \
    return text.c_str();                                                                                               \
  }                                                                                                                    \
  int mpmstab_set(const char name[], double value)                                                                     \
  {                                                                                                                    \
    return mpmstab::caught([&] { Code::set(name, value); });                                                           \
  }                                                                                                                    \
  int mpmstab_step(int steps, int64_t particles, double state[])                                                       \
  {                                                                                                                    \
    return mpmstab::caught([&] {                                                                                       \
      for (int n = 0; n < steps; n++) Code::step(state, (std::size_t)particles);                                       \
    });                                                                                                                \
  }                                                                                                                    \
  const char *mpmstab_error(void)                                                                                      \
  {                                                                                                                    \
    return mpmstab::wrong().c_str();                                                                                   \
  }
