// Free space in n dimensions: a box without boxes and balls, tested exactly; and an arm in the
// plane among discs, which can only be tested at single states.

#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <istream>
#include <limits>
#include <vector>

using Numbers = std::vector<double>;

inline Numbers read_numbers(std::istream & stream, std::size_t count)
{
  Numbers numbers(count);
  for (double & number : numbers) {
    stream >> number;
  }
  return numbers;
}

struct Box
{
  Numbers lower, upper;

  bool touches(const double * x) const
  {
    for (std::size_t i = 0; i < lower.size(); ++i) {
      if (x[i] < lower[i] || x[i] > upper[i]) {
        return false;
      }
    }
    return true;
  }

  // The first part of the segment from a to b at which it touches the box; infinity for none.
  double entry(const double * a, const double * b) const
  {
    double first = 0.0, last = 1.0;
    for (std::size_t i = 0; i < lower.size(); ++i) {
      const double u = b[i] - a[i];
      if (u == 0.0) {
        if (a[i] < lower[i] || a[i] > upper[i]) {
          return std::numeric_limits<double>::infinity();
        }
        continue;
      }
      const double s = (lower[i] - a[i]) / u, t = (upper[i] - a[i]) / u;
      first = std::max(first, std::min(s, t));
      last = std::min(last, std::max(s, t));
      if (first > last) {
        return std::numeric_limits<double>::infinity();
      }
    }
    return first;
  }
};

struct Ball
{
  Numbers centre;
  double radius;

  bool touches(const double * x) const
  {
    double squared = 0.0;
    for (std::size_t i = 0; i < centre.size(); ++i) {
      squared += (x[i] - centre[i]) * (x[i] - centre[i]);
    }
    return squared <= radius * radius;
  }

  // The first part of the segment from a to b at which it touches the ball; infinity for none.
  double entry(const double * a, const double * b) const
  {
    double along = 0.0, ahead = 0.0, squared = 0.0;
    for (std::size_t i = 0; i < centre.size(); ++i) {
      const double u = b[i] - a[i], offset = centre[i] - a[i];
      along += u * u;
      ahead += u * offset;
      squared += offset * offset;
    }
    const double outside = squared - radius * radius;
    if (outside <= 0.0) {
      return 0.0;
    }
    const double discriminant = ahead * ahead - along * outside;
    if (ahead <= 0.0 || discriminant < 0.0) {
      return std::numeric_limits<double>::infinity();
    }
    const double first = outside / (ahead + std::sqrt(discriminant));
    return first <= 1.0 ? first : std::numeric_limits<double>::infinity();
  }
};

struct Solids
{
  std::vector<Box> boxes;
  std::vector<Ball> balls;

  bool is_free(const double * x) const
  {
    const auto touches = [x](const auto & solid) {return solid.touches(x);};
    return std::none_of(balls.begin(), balls.end(), touches) &&
           std::none_of(boxes.begin(), boxes.end(), touches);
  }

  // Whether the segment from a to b touches nothing.
  bool is_free(const double * a, const double * b) const
  {
    const auto touches = [a, b](const auto & solid) {return solid.entry(a, b) <= 1.0;};
    return std::none_of(balls.begin(), balls.end(), touches) &&
           std::none_of(boxes.begin(), boxes.end(), touches);
  }

  // The part of the segment from a to b before it touches something, at least 1 for all of it.
  double free_part(const double * a, const double * b) const
  {
    double part = std::numeric_limits<double>::infinity();
    for (const Ball & ball : balls) {
      part = std::min(part, ball.entry(a, b));
    }
    for (const Box & box : boxes) {
      part = std::min(part, box.entry(a, b));
    }
    return part;
  }
};

// Links of one length, which add up to 1, from the origin; angles are from link to link.
struct Arm
{
  std::size_t links;
  std::vector<double> discs;  // x, y, radius, x, y, radius, ...

  bool is_free(const double * angles) const
  {
    const double length = 1.0 / links;
    double x = 0.0, y = 0.0, heading = 0.0;
    for (std::size_t i = 0; i < links; ++i) {
      heading += angles[i];
      const double ux = length * std::cos(heading), uy = length * std::sin(heading);
      for (std::size_t k = 0; k < discs.size(); k += 3) {
        const double dx = discs[k] - x, dy = discs[k + 1] - y;
        const double along =
          std::min(1.0, std::max(0.0, (dx * ux + dy * uy) / (length * length)));
        const double ox = dx - along * ux, oy = dy - along * uy;
        if (ox * ox + oy * oy <= discs[k + 2] * discs[k + 2]) {
          return false;
        }
      }
      x += ux;
      y += uy;
    }
    return true;
  }
};
