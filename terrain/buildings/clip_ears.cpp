#include "terrain/buildings/clip_ears.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <limits>
#include <optional>
#include <utility>

namespace obliq {
namespace {

/// Twice the area of a, b, c: positive when they turn to the left.
double turn(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c) {
  const glm::dvec2 u = b - a;
  const glm::dvec2 v = c - b;
  return u.x * v.y - u.y * v.x;
}

class EarClipper {
 public:
  explicit EarClipper(const FloatRings& rings) {
    for (const FloatRing& ring : rings)
      for (const glm::vec2 p : ring) points_.emplace_back(p);
    std::uint32_t first = 0;
    for (const FloatRing& ring : rings) {
      const auto n = static_cast<std::uint32_t>(ring.size());
      for (std::uint32_t k = 0; k < n; ++k)
        corners_.push_back({first + k, first + (k + n - 1) % n, first + (k + 1) % n});
      if (first > 0) holes_.push_back(rightmost(first, n));
      first += n;
    }
  }

  /// False: a hole sees no corner that it could be joined to.
  bool join_holes() {
    // From the right: what a hole sees to its right is then one ring already.
    std::ranges::sort(holes_, [this](std::uint32_t a, std::uint32_t b) {
      return at(a).x != at(b).x ? at(a).x > at(b).x : a < b;
    });
    for (const std::uint32_t hole : holes_) {
      const auto seen = corner_seen_from(hole);
      if (!seen) return false;
      join(*seen, hole);
    }
    return true;
  }

  std::uint64_t looks() const { return looks_; }

  /// Empty: it has found no ear.
  std::vector<glm::uvec3> triangles() {
    for (std::uint32_t c = 0; c < corners_.size(); ++c)
      if (is_reflex(c)) reflex_.push_back(c);
    std::vector<glm::uvec3> found;
    std::size_t left = corners_.size();
    std::size_t unchanged = 0;
    for (std::uint32_t c = 0; left > 2;) {
      Corner& corner = corners_[c];
      if (!corner.no_ear && is_ear(c)) {
        found.emplace_back(corners_[corner.previous].point, corner.point, corners_[corner.next].point);
        remove(c);
        --left;
        unchanged = 0;
        c = corners_[corner.next].next;  // not the next: ears of one corner after the other are slivers
        continue;
      }
      corner.no_ear = true;
      c = corner.next;
      if (++unchanged > left) return {};
    }
    return found;
  }

 private:
  struct Corner {
    std::uint32_t point;
    std::uint32_t previous, next;
    bool no_ear = false;  ///< since a neighbour has gone last
    bool gone = false;
  };

  glm::dvec2 at(std::uint32_t corner) const { return points_[corners_[corner].point]; }
  glm::dvec2 before(std::uint32_t corner) const { return at(corners_[corner].previous); }
  glm::dvec2 after(std::uint32_t corner) const { return at(corners_[corner].next); }
  bool is_reflex(std::uint32_t corner) const {
    return !(turn(before(corner), at(corner), after(corner)) > 0);
  }

  std::uint32_t rightmost(std::uint32_t first, std::uint32_t n) const {
    std::uint32_t best = first;
    for (std::uint32_t c = first; c < first + n; ++c)
      if (at(c).x > at(best).x) best = c;
    return best;
  }

  /// Whether a line from the corner to the point begins inside (O'Rourke, "InCone").
  bool looks_inside(std::uint32_t corner, glm::dvec2 to) const {
    const glm::dvec2 a = before(corner), p = at(corner), b = after(corner);
    if (!is_reflex(corner)) return turn(p, to, a) > 0 && turn(to, p, b) > 0;
    return !(turn(p, to, b) >= 0 && turn(to, p, a) >= 0);
  }

  /// A corner of the outer ring, with what is joined to it, that is in sight of a hole's rightmost corner
  /// (Eberly, section 5).
  std::optional<std::uint32_t> corner_seen_from(std::uint32_t hole) const {
    const glm::dvec2 from = at(hole);
    double nearest_x = std::numeric_limits<double>::infinity();
    std::uint32_t edge = 0;
    std::uint32_t c = 0;
    do {  // edges that go up have the inside to their left
      const glm::dvec2 a = at(c), b = after(c);
      if (a.y <= from.y && b.y > from.y) {
        const double x = a.x + (from.y - a.y) / (b.y - a.y) * (b.x - a.x);
        if (x >= from.x && x < nearest_x) {
          nearest_x = x;
          edge = c;
        }
      }
      c = corners_[c].next;
    } while (c != 0);
    if (!std::isfinite(nearest_x)) return std::nullopt;
    // The far end of the edge, or what stands before it: of that, what is nearest to the ray by angle.
    const glm::dvec2 hit(nearest_x, from.y);
    const std::uint32_t end = at(edge).y == from.y || at(edge).x > after(edge).x ? edge : corners_[edge].next;
    glm::dvec2 corner_of_triangle = at(end);
    std::optional<std::uint32_t> best;
    double best_slope = std::numeric_limits<double>::infinity();
    double best_distance = 0;
    do {
      const glm::dvec2 p = at(c);
      const bool is_end = p == corner_of_triangle;
      if (p.x >= from.x && (is_end || (is_reflex(c) && in_triangle(p, from, hit, corner_of_triangle))) &&
          looks_inside(c, from)) {
        const double slope = std::abs(p.y - from.y) / (p.x - from.x);
        const double distance = glm::dot(p - from, p - from);
        if (slope < best_slope || (slope == best_slope && distance < best_distance)) {
          best = c;
          best_slope = slope;
          best_distance = distance;
        }
      }
      c = corners_[c].next;
    } while (c != 0);
    return best;
  }

  /// In the closed triangle, which may turn either way.
  static bool in_triangle(glm::dvec2 p, glm::dvec2 a, glm::dvec2 b, glm::dvec2 c) {
    const double u = turn(a, b, p), v = turn(b, c, p), w = turn(c, a, p);
    return (u >= 0 && v >= 0 && w >= 0) || (u <= 0 && v <= 0 && w <= 0);
  }

  /// There and back by a line between the two, which makes a second corner at either end.
  void join(std::uint32_t outer, std::uint32_t hole) {
    const auto hole_again = static_cast<std::uint32_t>(corners_.size());
    const std::uint32_t outer_again = hole_again + 1;
    const std::uint32_t onwards = corners_[outer].next, last = corners_[hole].previous;
    corners_.push_back({corners_[hole].point, last, outer_again});
    corners_.push_back({corners_[outer].point, hole_again, onwards});
    corners_[last].next = hole_again;
    corners_[onwards].previous = outer_again;
    corners_[outer].next = hole;
    corners_[hole].previous = outer;
  }

  bool is_ear(std::uint32_t corner) {
    const glm::dvec2 a = before(corner), b = at(corner), c = after(corner);
    if (!(turn(a, b, c) > 0)) return false;
    const glm::dvec2 low = glm::min(glm::min(a, b), c), high = glm::max(glm::max(a, b), c);
    looks_ += reflex_.size();
    return std::ranges::none_of(reflex_, [&](std::uint32_t r) {
      const glm::dvec2 p = at(r);
      if (p.x < low.x || p.x > high.x || p.y < low.y || p.y > high.y) return false;
      if (corners_[r].gone || r == corners_[corner].previous || r == corners_[corner].next) return false;
      // Where two corners share a place, the other's edges may lead into the ear.
      if (p == a) return leads_into(r, a, b, c);
      if (p == b) return leads_into(r, b, c, a);
      if (p == c) return leads_into(r, c, a, b);
      return turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0;
    });
  }

  /// Whether an edge of the corner, which is at `tip`, lies between the directions to `right` and `left`.
  bool leads_into(std::uint32_t corner, glm::dvec2 tip, glm::dvec2 right, glm::dvec2 left) const {
    const auto between = [&](glm::dvec2 p) { return turn(tip, right, p) > 0 && turn(tip, p, left) > 0; };
    return between(before(corner)) || between(after(corner));
  }

  void remove(std::uint32_t corner) {
    Corner& c = corners_[corner];
    corners_[c.previous].next = c.next;
    corners_[c.next].previous = c.previous;
    corners_[c.previous].no_ear = corners_[c.next].no_ear = false;
    c.gone = true;
  }

  std::vector<glm::dvec2> points_;
  std::vector<Corner> corners_;
  std::vector<std::uint32_t> holes_;  ///< rightmost corner of each
  std::uint64_t looks_ = 0;
  std::vector<std::uint32_t> reflex_;  ///< at first: no others can stand in an ear
};

}  // namespace

std::vector<glm::uvec3> clip_ears(const FloatRings& rings, std::uint64_t* looks) {
  EarClipper clipper(rings);
  if (!clipper.join_holes()) return {};
  std::vector<glm::uvec3> found = clipper.triangles();
  if (looks != nullptr) *looks += clipper.looks();
  return found;
}

}  // namespace obliq
