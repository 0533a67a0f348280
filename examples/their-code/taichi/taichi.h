/*
   What mls-mpm88-explained.cpp uses of taichi.h, written anew: vectors and matrices in single precision, and a window
   that shows nothing. So nothing but the code itself has to be fetched.
*/
#pragma once
#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>
#include <vector>

namespace taichi
{
using real = float;

constexpr real operator""_f(long double x)
{
  return (real)x;
}

inline real clamp(real x, real low, real high)
{
  return std::min(std::max(x, low), high);
}

/* ---- vectors: operations are number by number ---- */

struct Vector2i;

struct Vector3 {
  real d[3];

  explicit Vector3(real all = 0) : d{all, all, all} {}
  Vector3(real x, real y, real z) : d{x, y, z} {}
  Vector3(const struct Vector2 &xy, real z);
  real    &operator[](int i) { return d[i]; }
  real     operator[](int i) const { return d[i]; }
  Vector3 &operator+=(const Vector3 &b) { return *this = Vector3(d[0] + b[0], d[1] + b[1], d[2] + b[2]); }
  Vector3 &operator/=(real by) { return *this = Vector3(d[0] / by, d[1] / by, d[2] / by); }
};

struct Vector2 {
  real x, y;

  explicit Vector2(real both = 0) : x(both), y(both) {}
  explicit Vector2(const Vector3 &longer) : x(longer[0]), y(longer[1]) {}
  Vector2(real x, real y) : x(x), y(y) {}
  template <class Integer> Vector2i cast() const;
  real    &operator[](int i) { return i ? y : x; }
  real     operator[](int i) const { return i ? y : x; }
  Vector2 &operator+=(const Vector2 &b) { return *this = Vector2(x + b.x, y + b.y); }

  static Vector2 rand()
  {
    static std::minstd_rand                     source;
    static std::uniform_real_distribution<real> number(0, 1);
    const real                                  first = number(source);

    return Vector2(first, number(source));
  }
};

struct Vector2i {
  int x, y;

  template <class Real> Vector2 cast() const { return Vector2((Real)x, (Real)y); }
};

template <class Integer> Vector2i Vector2::cast() const
{
  return {(Integer)x, (Integer)y};
}

inline Vector3::Vector3(const Vector2 &xy, real z) : d{xy.x, xy.y, z} {}

inline Vector3 operator+(Vector3 a, const Vector3 &b) { return a += b; }
inline Vector3 operator*(real a, const Vector3 &b) { return Vector3(a * b[0], a * b[1], a * b[2]); }
inline Vector2 operator+(Vector2 a, const Vector2 &b) { return a += b; }
inline Vector2 operator-(const Vector2 &a, const Vector2 &b) { return Vector2(a.x - b.x, a.y - b.y); }
inline Vector2 operator*(const Vector2 &a, const Vector2 &b) { return Vector2(a.x * b.x, a.y * b.y); }
inline Vector2 operator*(real a, const Vector2 &b) { return Vector2(a * b.x, a * b.y); }
inline Vector2 operator*(const Vector2 &a, real b) { return b * a; }
inline Vector2 sqr(const Vector2 &a) { return a * a; }

/* ---- matrices: by columns; a number is the matrix with this number on its diagonal ---- */

struct Matrix2 {
  Vector2 column[2];

  Matrix2(real diagonal = 0) : column{Vector2(diagonal, 0), Vector2(0, diagonal)} {}
  Matrix2(const Vector2 &first, const Vector2 &second) : column{first, second} {}
  Vector2       &operator[](int j) { return column[j]; }
  const Vector2 &operator[](int j) const { return column[j]; }
  Matrix2 &operator+=(const Matrix2 &b) { return *this = Matrix2(column[0] + b[0], column[1] + b[1]); }
  static Matrix2 outer_product(const Vector2 &a, const Vector2 &b) { return Matrix2(b.x * a, b.y * a); }
};

inline Vector2 operator*(const Matrix2 &a, const Vector2 &b) { return b.x * a[0] + b.y * a[1]; }
inline Matrix2 operator*(const Matrix2 &a, const Matrix2 &b) { return Matrix2(a * b[0], a * b[1]); }
inline Matrix2 operator+(Matrix2 a, const Matrix2 &b) { return a += b; }
inline Matrix2 operator-(const Matrix2 &a, const Matrix2 &b) { return Matrix2(a[0] - b[0], a[1] - b[1]); }
inline Matrix2 transposed(const Matrix2 &a) { return Matrix2({a[0].x, a[1].x}, {a[0].y, a[1].y}); }
inline real    determinant(const Matrix2 &a) { return a[0].x * a[1].y - a[1].x * a[0].y; }

/* a = rotation times symmetric, in closed form. */
inline void polar_decomp(const Matrix2 &a, Matrix2 &rotation, Matrix2 &symmetric)
{
  const Vector2 trace(a[0].x + a[1].y, a[0].y - a[1].x);
  const real    length = std::hypot(trace.x, trace.y), c = trace.x / length, s = trace.y / length;

  rotation  = Matrix2({c, s}, {-s, c});
  symmetric = transposed(rotation) * a;
}

/* a = u sigma v^T, by the rotation v that makes the symmetric factor of a diagonal. */
inline void svd(const Matrix2 &a, Matrix2 &u, Matrix2 &sigma, Matrix2 &v)
{
  Matrix2 rotation, s;

  polar_decomp(a, rotation, s);
  const real angle = std::atan2(2 * s[1].x, s[0].x - s[1].y) / 2;
  v                = Matrix2({std::cos(angle), std::sin(angle)}, {-std::sin(angle), std::cos(angle)});
  s                = transposed(v) * s * v;
  sigma            = Matrix2({s[0].x, 0}, {0, s[1].y});
  u                = rotation * v;
}

/* ---- a window that shows nothing ---- */

struct Shape {
  template <class Number> Shape &radius(Number) { return *this; }
  Shape &color(int) { return *this; }
  void   close() {}
};

struct Canvas {
  void  clear(int) {}
  Shape rect(const Vector2 &, const Vector2 &) { return {}; }
  Shape circle(const Vector2 &) { return {}; }
};

struct GUI {
  Canvas canvas;

  GUI(const char *, int, int) {}
  Canvas &get_canvas() { return canvas; }
  void    update() {}
};
} // namespace taichi
