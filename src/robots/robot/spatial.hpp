// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace pcavr::robot {

/// Two numbers that go through the same operations: the halves of a spatial vector or inertia,
/// which turn alike. A vector of GCC and Clang, in one register of any 64-bit processor; lanes are
/// [0], [1].
using Pair = double __attribute__((vector_size(16)));

/// Three numbers (or pairs of them) in body axes. Plain scalars: at this size the compiler does
/// better with them than with expression templates.
template <typename T>
struct Triple {
  T x{};
  T y{};
  T z{};
};
using Vec = Triple<double>;
using VecPair = Triple<Pair>;

inline Vec to_vec(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }
inline Eigen::Vector3d to_eigen(const Vec& v) { return {v.x, v.y, v.z}; }
inline VecPair paired(const Vec& a, const Vec& b) {
  return {Pair{a.x, b.x}, Pair{a.y, b.y}, Pair{a.z, b.z}};
}
inline Vec first(const VecPair& v) { return {v.x[0], v.y[0], v.z[0]}; }
inline Vec second(const VecPair& v) { return {v.x[1], v.y[1], v.z[1]}; }

template <typename T>
Triple<T> operator+(const Triple<T>& a, const Triple<T>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <typename T>
Triple<T> operator*(double s, const Triple<T>& a) {
  return {s * a.x, s * a.y, s * a.z};
}
template <typename T>
T dot(const Triple<T>& a, const Triple<T>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline Vec cross(const Vec& a, const Vec& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// A symmetric 3x3 matrix, or a pair of them.
template <typename T>
struct Symmetric {
  T xx{};
  T xy{};
  T xz{};
  T yy{};
  T yz{};
  T zz{};
};
using Sym = Symmetric<double>;
using SymPair = Symmetric<Pair>;

inline SymPair paired(const Sym& a, const Sym& b) {
  return {Pair{a.xx, b.xx}, Pair{a.xy, b.xy}, Pair{a.xz, b.xz},
          Pair{a.yy, b.yy}, Pair{a.yz, b.yz}, Pair{a.zz, b.zz}};
}
inline Sym second(const SymPair& m) {
  return {m.xx[1], m.xy[1], m.xz[1], m.yy[1], m.yz[1], m.zz[1]};
}
template <typename T>
Symmetric<T> operator+(const Symmetric<T>& a, const Symmetric<T>& b) {
  return {a.xx + b.xx, a.xy + b.xy, a.xz + b.xz, a.yy + b.yy, a.yz + b.yz, a.zz + b.zz};
}

inline Sym to_sym(const Eigen::Matrix3d& m) {
  return {m(0, 0), m(0, 1), m(0, 2), m(1, 1), m(1, 2), m(2, 2)};
}
inline Vec operator*(const Sym& m, const Vec& v) {
  return {m.xx * v.x + m.xy * v.y + m.xz * v.z, m.xy * v.x + m.yy * v.y + m.yz * v.z,
          m.xz * v.x + m.yz * v.y + m.zz * v.z};
}

/// A 3x3 matrix as its rows.
struct Rows {
  Vec x;
  Vec y;
  Vec z;
};

inline Vec operator*(const Rows& m, const Vec& v) {
  return {dot(m.x, v), dot(m.y, v), dot(m.z, v)};
}

/// An angle as its cosine and sine.
struct Turn {
  double c = 1.0;
  double s = 0.0;
};

// Rz v, Rz^T v, Rx v, Rx^T v.
template <typename T>
Triple<T> about_z(const Turn& t, const Triple<T>& v) {
  return {t.c * v.x - t.s * v.y, t.s * v.x + t.c * v.y, v.z};
}
template <typename T>
Triple<T> back_about_z(const Turn& t, const Triple<T>& v) {
  return {t.c * v.x + t.s * v.y, t.c * v.y - t.s * v.x, v.z};
}
template <typename T>
Triple<T> about_x(const Turn& t, const Triple<T>& v) {
  return {v.x, t.c * v.y - t.s * v.z, t.s * v.y + t.c * v.z};
}
template <typename T>
Triple<T> back_about_x(const Turn& t, const Triple<T>& v) {
  return {v.x, t.c * v.y + t.s * v.z, t.c * v.z - t.s * v.y};
}

// R m R^T.
template <typename T>
Symmetric<T> about_z(const Turn& t, const Symmetric<T>& m) {
  const double cs = t.c * t.s;
  const double cc = t.c * t.c;
  const T difference = m.xx - m.yy;
  const T a = cc * difference - 2.0 * cs * m.xy;
  return {m.yy + a,
          cs * difference + (cc - t.s * t.s) * m.xy,
          t.c * m.xz - t.s * m.yz,
          m.xx - a,
          t.s * m.xz + t.c * m.yz,
          m.zz};
}
template <typename T>
Symmetric<T> about_x(const Turn& t, const Symmetric<T>& m) {
  const double cs = t.c * t.s;
  const double cc = t.c * t.c;
  const T difference = m.yy - m.zz;
  const T a = cc * difference - 2.0 * cs * m.yz;
  return {m.xx,
          t.c * m.xy - t.s * m.xz,
          t.s * m.xy + t.c * m.xz,
          m.zz + a,
          cs * difference + (cc - t.s * t.s) * m.yz,
          m.yy - a};
}
inline Rows about_z(const Turn& t, const Rows& m) {
  const Vec x = about_z(t, m.x);
  const Vec y = about_z(t, m.y);
  return {{t.c * x.x - t.s * y.x, t.c * x.y - t.s * y.y, t.c * x.z - t.s * y.z},
          {t.s * x.x + t.c * y.x, t.s * x.y + t.c * y.y, t.s * x.z + t.c * y.z},
          about_z(t, m.z)};
}
inline Rows about_x(const Turn& t, const Rows& m) {
  const Vec y = about_x(t, m.y);
  const Vec z = about_x(t, m.z);
  return {about_x(t, m.x),
          {t.c * y.x - t.s * z.x, t.c * y.y - t.s * z.y, t.c * y.z - t.s * z.z},
          {t.s * y.x + t.c * z.x, t.s * y.y + t.c * z.y, t.s * y.z + t.c * z.z}};
}

/// An articulated-body inertia: moment = rotation * domega + coupling * a,
/// force = coupling^T * domega + translation * a [Featherstone 2008, eq. 7.2 in blocks].
struct ArticulatedInertia {
  SymPair blocks;  ///< rotation, translation
  Rows coupling;
};

/// The same about a point at -p, in the same axes: a = a' + domega x p, moment' = moment + p x
/// force.
inline ArticulatedInertia shifted(const ArticulatedInertia& inertia, const Vec& p) {
  const Sym m = second(inertia.blocks);
  const Rows& h = inertia.coupling;
  const Rows h_shifted{{h.x.x + p.y * m.xz - p.z * m.xy, h.x.y + p.y * m.yz - p.z * m.yy,
                        h.x.z + p.y * m.zz - p.z * m.yz},
                       {h.y.x + p.z * m.xx - p.x * m.xz, h.y.y + p.z * m.xy - p.x * m.yz,
                        h.y.z + p.z * m.xz - p.x * m.zz},
                       {h.z.x + p.x * m.xy - p.y * m.xx, h.z.y + p.x * m.yy - p.y * m.xy,
                        h.z.z + p.x * m.yz - p.y * m.xz}};
  const Rows& g = h_shifted;
  // Entry i, j: (p x row i of h)_j + (p x row j of g)_i.
  ArticulatedInertia result{inertia.blocks, h_shifted};
  SymPair& r = result.blocks;
  r.xx[0] += p.y * (h.x.z + g.x.z) - p.z * (h.x.y + g.x.y);
  r.xy[0] += p.z * h.x.x - p.x * h.x.z + p.y * g.y.z - p.z * g.y.y;
  r.xz[0] += p.x * h.x.y - p.y * h.x.x + p.y * g.z.z - p.z * g.z.y;
  r.yy[0] += p.z * (h.y.x + g.y.x) - p.x * (h.y.z + g.y.z);
  r.yz[0] += p.x * h.y.y - p.y * h.y.x + p.z * g.z.x - p.x * g.z.z;
  r.zz[0] += p.x * (h.z.y + g.z.y) - p.y * (h.z.x + g.z.x);
  return result;
}

inline void add_to(ArticulatedInertia& sum, const ArticulatedInertia& b) {
  sum = {sum.blocks + b.blocks,
         {sum.coupling.x + b.coupling.x, sum.coupling.y + b.coupling.y,
          sum.coupling.z + b.coupling.z}};
}

}  // namespace pcavr::robot
