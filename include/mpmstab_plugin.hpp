/*
   mpmstab_plugin.hpp: a plugin for mpmstab in C++. Give the code as a class, and name it once in one file:

     struct Mine {
       static std::string describe();                       the description of <mpmstab/plugin.h>, in JSON
       static std::vector<double> base();                   the base state, particle by particle
       static void set(const std::string &name, double value);
       static void step(double *state, std::size_t particles);
     };
     MPMSTAB_PLUGIN(Mine)

   A code that describes "scenes": true also has

       static void scene(const std::string &message, std::size_t particles, const double *period, const double *given, double *state);

   and MPMSTAB_SCENES(Mine) after MPMSTAB_PLUGIN(Mine). Its base state may be empty.

   It is built as a shared library: c++ -fPIC -shared -o libmine.so mine.cpp. What set and step throw is their error.
*/
#pragma once
#include <cstddef>
#include <exception>
#include <string>
#include <vector>
#include <mpmstab/plugin.h>

/* Does something; 1 when that throws, and then mpmstab_error says what. */
template <class Action> int mpmstab_caught(Action action, std::string &wrong)
{
  try {
    action();
    return 0;
  } catch (const std::exception &e) {
    wrong = e.what();
  } catch (...) {
    wrong = "an exception that is no std::exception";
  }
  return 1;
}

#define MPMSTAB_PLUGIN(Code)                                                                                           \
  static std::string         mpmstab_text, mpmstab_wrong;                                                              \
  static std::vector<double> mpmstab_base;                                                                             \
  const char                *mpmstab_describe(const double **state)                                                    \
  {                                                                                                                    \
    const auto start = [] { mpmstab_text = Code::describe(), mpmstab_base = Code::base(); };                           \
    if (mpmstab_caught(start, mpmstab_wrong)) return nullptr;                                                          \
    *state = mpmstab_base.empty() ? nullptr : mpmstab_base.data();                                                     \
    return mpmstab_text.c_str();                                                                                       \
  }                                                                                                                    \
  int mpmstab_set(const char name[], double value)                                                                     \
  {                                                                                                                    \
    return mpmstab_caught([&] { Code::set(name, value); }, mpmstab_wrong);                                             \
  }                                                                                                                    \
  int mpmstab_step(int steps, int64_t particles, double state[])                                                       \
  {                                                                                                                    \
    const auto all = [&] {                                                                                             \
      while (steps-- > 0) Code::step(state, (std::size_t)particles);                                                   \
    };                                                                                                                 \
    return mpmstab_caught(all, mpmstab_wrong);                                                                         \
  }                                                                                                                    \
  const char *mpmstab_error(void) { return mpmstab_wrong.c_str(); }

#define MPMSTAB_SCENES(Code)                                                                                           \
  int mpmstab_scene(const char message[], int64_t particles, const double period[], const double given[], double state[]) \
  {                                                                                                                    \
    return mpmstab_caught([&] { Code::scene(message, (std::size_t)particles, period, given, state); }, mpmstab_wrong); \
  }
