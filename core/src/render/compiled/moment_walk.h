#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

namespace plenoflame {

/// Random numbers of one walk, a function of its seed alone.
class WalkRandom {
 public:
  explicit WalkRandom(std::uint64_t seed) : state_(seed) {}
  double uniform();  ///< in (0, 1)

 private:
  std::uint64_t state_;
};

/// Reduces a rule (points with positive weights) to at most as many points as functions whose sums
/// it keeps (Caratheodory, Tchakaloff). Points are added one by one. With one point more than
/// functions, there is a change of the weights that keeps all sums. The walk makes this change in
/// one of its two directions until a weight vanishes. The direction is random, so that the change
/// is 0 on average. Every weight therefore keeps its mean, and the reduced rule has no bias for any
/// function. This is the flight of the cube method (J.-C. Deville, Y. Tille, "Efficient balanced
/// sampling: the cube method", Biometrika 91 (2004), 893), without upper bounds.
class MomentWalk {
 public:
  explicit MomentWalk(std::size_t functions);
  void start();
  /// @param values of the functions at the point; the first is 1 @param weight > 0
  void add(std::size_t point, const double* values, double weight, WalkRandom& random);

  struct Kept {
    std::size_t point;
    double weight;
  };
  /// The remaining points.
  std::vector<Kept> kept() const;

 private:
  static constexpr std::size_t kFree = ~std::size_t{0};  ///< marks a unit vector without a point
  /// As add() if no place is free, for n functions; the compiler knows n.
  template <std::size_t n>
  void add_to_full(std::size_t point, const double* values, double weight, WalkRandom& random);
  void exchange(std::size_t place, const double* change, std::size_t n);

  std::size_t n_, free_;         ///< functions, and places without a point
  std::vector<double> inverse_;  ///< of the kept points' values, column by column
  std::vector<double> weights_, change_;
  std::vector<std::size_t> points_;
};

}  // namespace plenoflame
