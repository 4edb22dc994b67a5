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

/// Reduces a rule (points with positive weights) to at most as many points as there are functions
/// whose sums it keeps (Caratheodory, Tchakaloff). Points come one by one. As soon as there is one
/// more than functions, some change of the weights leaves all sums as they are: it is made in one
/// direction or the other until a weight vanishes, by chance, so that the change is 0 on average.
/// Every weight is therefore on average what it was: the reduced rule has no bias for any function
/// at all. That is the flight of the cube method (J.-C. Deville, Y. Tille, "Efficient balanced
/// sampling: the cube method", Biometrika 91 (2004), 893), without upper bounds.
class MomentWalk {
 public:
  explicit MomentWalk(std::size_t functions);
  void start();
  /// @param values of the functions at the point, the first is 1   @param weight > 0
  void add(std::size_t point, const double* values, double weight, WalkRandom& random);

  struct Kept {
    std::size_t point;
    double weight;
  };
  /// The points that are left.
  std::vector<Kept> kept() const;

 private:
  static constexpr std::size_t kFree = ~std::size_t{0};  ///< no point, but a unit vector
  /// As add() where no place is free, for n functions; n is known to the compiler.
  template <std::size_t n>
  void add_to_full(std::size_t point, const double* values, double weight, WalkRandom& random);
  void exchange(std::size_t place, const double* change, std::size_t n);

  std::size_t n_, free_;         ///< functions, and places without a point
  std::vector<double> inverse_;  ///< of the kept points' values, column by column
  std::vector<double> weights_, change_;
  std::vector<std::size_t> points_;
};

}  // namespace plenoflame
