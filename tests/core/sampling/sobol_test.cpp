#include "plenoflame/sampling/sobol.h"

#include <cmath>
#include <random>
#include <set>
#include <vector>

#include "support/approx.h"

namespace plenoflame::test::sobol_test {
namespace {

/// Tells if every one of 2^m consecutive cells holds exactly one value.
template <class Value>
bool one_per_cell(int m, const Value& value) {
  std::vector<int> hits(std::size_t{1} << m);
  for (std::uint32_t i = 0; i < (1u << m); ++i) {
    const std::uint32_t v = value(i);
    ++hits[m == 0 ? 0 : v >> (32 - m)];
  }
  for (const int h : hits)
    if (h != 1) return false;
  return true;
}

TEST(Sobol, FirstPoints) {
  // Joe and Kuo's published example of three dimensions, in units of 1/8; in Gray code order there
  // and in natural order here, so the first eight points are compared as a set.
  const std::set<std::vector<int>> expected{{0, 0, 0}, {4, 4, 4}, {2, 6, 6}, {6, 2, 2},
                                            {1, 5, 3}, {5, 1, 7}, {3, 3, 5}, {7, 7, 1}};
  std::set<std::vector<int>> actual;
  for (std::uint32_t i = 0; i < 8; ++i)
    actual.insert({static_cast<int>(sobol(i, 0) >> 29), static_cast<int>(sobol(i, 1) >> 29),
                   static_cast<int>(sobol(i, 2) >> 29)});
  EXPECT_EQ(actual, expected);
}

TEST(Sobol, EveryDimensionIsStratified) {
  for (int d = 0; d < kSobolDimensions; ++d)
    for (int m = 0; m <= 12; ++m)
      for (const std::uint32_t start : {0u, 1u, 5u, 1000u})  // any aligned stretch
        EXPECT_TRUE(one_per_cell(m, [&](std::uint32_t i) { return sobol((start << m) + i, d); }))
            << "dimension " << d << ", 2^" << m << " points";
}

TEST(Sobol, QualityOfEveryPairOfTheFirstFourDimensions) {
  // t of a Sobol sequence is at most the sum of (degree - 1) of its polynomials (Sobol 1967;
  // Niederreiter 1992, theorem 4.49): degrees 0 (van der Corput), 1, 2, 3. So a pair's intervals
  // of 2^(t - m) hold exactly 2^t points.
  const int excess[] = {0, 0, 1, 2};
  for (int p = 0; p < 4; ++p)
    for (int q = p + 1; q < 4; ++q) {
      const int t = excess[p] + excess[q];
      for (int m = t; m <= 12; ++m)
        for (int a = 0; a <= m - t; ++a) {
          const int b = m - t - a;
          std::vector<int> hits(std::size_t{1} << (m - t));
          for (std::uint32_t i = 0; i < (1u << m); ++i) {
            const std::uint32_t column = a == 0 ? 0 : sobol(i, p) >> (32 - a);
            const std::uint32_t row = b == 0 ? 0 : sobol(i, q) >> (32 - b);
            ++hits[(column << b) | row];
          }
          for (const int h : hits) ASSERT_EQ(h, 1 << t) << p << q << " m " << m << " a " << a;
        }
    }
}

TEST(OwenScramble, IsABijectionOfEveryPrefix) {
  // Two fractions that share their first k bits, and no more, still do so afterwards.
  for (std::uint64_t seed = 0; seed < 50; ++seed)
    for (int k = 0; k < 32; ++k) {
      const auto a = static_cast<std::uint32_t>(mix64(seed * 100 + static_cast<std::uint64_t>(k)));
      const std::uint32_t b = a ^ (0x80000000u >> k);
      const std::uint32_t difference = owen_scramble(a, seed) ^ owen_scramble(b, seed);
      ASSERT_NE(difference, 0u);
      EXPECT_EQ(difference >> (31 - k), 1u);
    }
}

TEST(OwenScramble, KeepsTheNet) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const auto x = [&](std::uint32_t i) { return owen_scramble(sobol(i, 0), mix64(seed)); };
    const auto y = [&](std::uint32_t i) { return owen_scramble(sobol(i, 1), mix64(seed + 1000)); };
    for (int m = 0; m <= 10; ++m)
      for (int a = 0; a <= m; ++a) {
        std::vector<int> hits(std::size_t{1} << m);
        for (std::uint32_t i = 0; i < (1u << m); ++i) {
          const std::uint32_t column = a == 0 ? 0 : x(i) >> (32 - a);
          const std::uint32_t row = a == m ? 0 : y(i) >> (32 - (m - a));
          ++hits[(column << (m - a)) | row];
        }
        for (const int h : hits) ASSERT_EQ(h, 1);
      }
  }
}

/// z-score of Pearson's chi-square for equal expected counts (normal approximation).
double chi_square_z(const std::vector<double>& counts) {
  double total = 0, chi2 = 0;
  for (const double c : counts) total += c;
  const double expected = total / static_cast<double>(counts.size());
  for (const double c : counts) chi2 += (c - expected) * (c - expected) / expected;
  const double degrees = static_cast<double>(counts.size()) - 1;
  return (chi2 - degrees) / std::sqrt(2 * degrees);
}

TEST(OwenScramble, EveryFractionBecomesUniform) {
  // Over seeds, the scrambled value of any one fraction is uniform, in its high and its low bits,
  // and so is the difference of two neighbours' flips.
  constexpr int kSeeds = 100000, kBins = 64;
  for (const std::uint32_t fraction : {0u, 0x80000000u, 0x12345678u, 0xffffffffu}) {
    std::vector<double> high(kBins), low(kBins), joint(kBins);
    for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
      const std::uint32_t v = owen_scramble(fraction, seed);
      const std::uint32_t w = owen_scramble(fraction ^ 0x80000000u, seed);
      ++high[v >> 26];
      ++low[v & 63];
      ++joint[((v >> 25) & 7) | ((w >> 25) & 7) << 3];
    }
    EXPECT_LT(std::fabs(chi_square_z(high)), 5) << fraction;
    EXPECT_LT(std::fabs(chi_square_z(low)), 5) << fraction;
    EXPECT_LT(std::fabs(chi_square_z(joint)), 5) << fraction;
  }
}

TEST(OwenScramble, NodesOfTheTreeFlipIndependently) {
  // The flip of a bit says nothing about a lower one of the same fraction, nor about a lower
  // one of a fraction that differs in one of the highest 18 bits.
  constexpr int kSeeds = 10000, kNested = 18, kBits = 32;
  const double half = kSeeds / 2.0, error = std::sqrt(kSeeds) / 2;
  const auto flips_of = [](std::uint32_t f, std::uint64_t seed) {
    return f ^ owen_scramble(f, mix64(seed));
  };
  const auto flipped = [](std::uint32_t flips, int bit) { return flips >> (31 - bit) & 1; };
  for (const std::uint32_t fraction : {0u, 0x9e3779b9u}) {
    std::vector<int> same(kBits * kBits), other(kBits * kBits);
    for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
      const std::uint32_t flips = flips_of(fraction, seed);
      for (int above = 0; above < kBits; ++above) {
        const std::uint32_t its = flips_of(fraction ^ (0x80000000u >> above), seed);
        for (int bit = above + 1; bit < kBits; ++bit) {
          const auto i = static_cast<std::size_t>(above * kBits + bit);
          same[i] += flipped(flips, above) == flipped(flips, bit);
          other[i] += flipped(flips, bit) == flipped(its, bit);
        }
        // Below, flips stay the same.
        if (above >= kNested) {
          ASSERT_EQ(flips, its);
        }
      }
    }
    for (int above = 0; above < kBits; ++above)
      for (int bit = above + 1; bit < kBits; ++bit) {
        const auto i = static_cast<std::size_t>(above * kBits + bit);
        EXPECT_TRUE(within_standard_errors(same[i], half, error, 5)) << above << " " << bit;
        if (above < kNested) {
          EXPECT_TRUE(within_standard_errors(other[i], half, error, 5)) << above << " " << bit;
        }
      }
  }
}

TEST(Mix64, EveryBitOfTheKeyFlipsHalfOfTheResult) {
  // Every bit of the result flips with probability 1/2 when one bit of the key flips.
  for (int in = 0; in < 64; ++in) {
    std::vector<double> flips(64);
    constexpr int kKeys = 4000;
    std::mt19937_64 random(static_cast<std::uint64_t>(in));
    for (int i = 0; i < kKeys; ++i) {
      const std::uint64_t key = random();
      const std::uint64_t difference = mix64(key) ^ mix64(key ^ (std::uint64_t{1} << in));
      for (int out = 0; out < 64; ++out)
        flips[static_cast<std::size_t>(out)] += (difference >> out) & 1;
    }
    for (const double f : flips)
      EXPECT_TRUE(within_standard_errors(f, kKeys / 2.0, std::sqrt(kKeys) / 2, 6));
  }
}

TEST(SobolPool, EntriesAreScrambledStretchesOfTheSequence) {
  for (const std::uint32_t first : {0u, 64u}) {
    const SobolPool pool(3, 64, first, 7);
    ASSERT_EQ(pool.replicates(), 3);
    ASSERT_EQ(pool.points(), 64);
    ASSERT_GE(pool.entries(), 16);
    for (int entry = 0; entry < 40; ++entry)
      for (int r = 0; r < 3; ++r) {
        const auto value = [&](int d) {
          return [&pool, entry, r, d](std::uint32_t i) {
            return pool.fractions(entry, d)[64 * r + static_cast<int>(i)];
          };
        };
        // Scrambled and shifted, dimensions 0 and 1 are a (0, 6, 2)-net; all are stratified.
        const std::uint32_t shift0 = 0x9abcdef1u * static_cast<std::uint32_t>(entry + 1),
                            shift1 = ~shift0;
        for (int d = 0; d < SobolPool::kDimensions; ++d) {
          EXPECT_TRUE(one_per_cell(6, value(d)));
          EXPECT_TRUE(one_per_cell(6, [&](std::uint32_t i) { return value(d)(i) ^ shift0; }));
        }
        for (int a = 0; a <= 6; ++a) {
          std::vector<int> hits(64);
          for (std::uint32_t i = 0; i < 64; ++i) {
            const std::uint32_t column = a == 0 ? 0 : (value(0)(i) ^ shift0) >> (32 - a);
            const std::uint32_t row = a == 6 ? 0 : (value(1)(i) ^ shift1) >> (26 + a);
            ++hits[(column << (6 - a)) | row];
          }
          for (const int h : hits) ASSERT_EQ(h, 1);
        }
      }
  }
}

TEST(SobolPool, EntriesReplicatesAndDimensionsAreIndependent) {
  // Correlation between the same point of different entries, replicates and dimensions. Over n
  // independent pairs it has the standard deviation 1 / sqrt(n).
  const SobolPool pool(2, 16, 0, 3);
  const auto unit = [&](int entry, int replicate, int d, int i) {
    return pool.fractions(entry, d)[16 * replicate + i] * 0x1p-32 - 0.5;
  };
  const int n = pool.entries() - 1;
  ASSERT_GE(n, 500);
  for (int i = 0; i < 16; ++i)
    for (int d = 0; d < 4; ++d) {
      double entries = 0, replicates = 0, dimensions = 0, mean = 0;
      for (int e = 0; e < n; ++e) {
        entries += unit(e, 0, d, i) * unit(e + 1, 0, d, i);
        replicates += unit(e, 0, d, i) * unit(e, 1, d, i);
        dimensions += unit(e, 0, d, i) * unit(e, 0, (d + 1) % 4, i);
        mean += unit(e, 0, d, i);
      }
      const double sigma = std::sqrt(static_cast<double>(n)) / 12;  // of a sum of n products
      EXPECT_TRUE(within_standard_errors(entries, 0, sigma, 5));
      EXPECT_TRUE(within_standard_errors(replicates, 0, sigma, 5));
      EXPECT_TRUE(within_standard_errors(dimensions, 0, sigma, 5));
      EXPECT_TRUE(within_standard_errors(mean, 0, std::sqrt(n / 12.0), 5));
    }
}

TEST(SobolPool, IsDeterminedByItsSeed) {
  const SobolPool a(2, 8, 0, 42), b(2, 8, 0, 42), c(2, 8, 0, 43);
  int same = 0, total = 0;
  for (int e = 0; e < a.entries(); ++e)
    for (int d = 0; d < 4; ++d)
      for (int i = 0; i < 16; ++i) {
        ASSERT_EQ(a.fractions(e, d)[i], b.fractions(e, d)[i]);
        same += a.fractions(e, d)[i] == c.fractions(e, d)[i];
        ++total;
      }
  EXPECT_LE(same, total / 1000);
}

TEST(SobolPool, ContinuesTheSequence) {
  // Points 8..15 of a pool that starts at 0 are those of a pool that starts at 8: the same
  // scramble. The number of entries depends on the size; the entries themselves must not.
  const SobolPool whole(1, 16, 0, 5), second(1, 8, 8, 5);
  for (int e = 0; e < 16; ++e)
    for (int d = 0; d < 4; ++d)
      for (int i = 0; i < 8; ++i)
        ASSERT_EQ(whole.fractions(e, d)[8 + i], second.fractions(e, d)[i]);
  // Wherever it goes on: the next index may differ in many bits.
  const SobolPool all(1, 4096, 0, 5);
  for (const std::uint32_t first : {1u, 255u, 1000u, 2040u, 4080u}) {
    const SobolPool part(1, 16, first, 5);
    for (int e = 0; e < 16; ++e)
      for (int d = 0; d < 4; ++d)
        for (std::uint32_t i = 0; i < 16; ++i)
          ASSERT_EQ(all.fractions(e, d)[first + i], part.fractions(e, d)[i]) << first << " " << i;
  }
}

TEST(SobolPool, NumbersOfReplicatesAreOddAndDiffer) {
  const SobolPool pool(5, 3, 0, 1);
  std::set<std::uint32_t> numbers;
  for (int r = 0; r < 5; ++r) {
    const std::uint32_t number = pool.replicate_numbers()[3 * r];
    for (int i = 0; i < 3; ++i) EXPECT_EQ(pool.replicate_numbers()[3 * r + i], number);
    EXPECT_EQ(number % 2, r == 0 ? 0U : 1U);
    numbers.insert(number);
  }
  EXPECT_EQ(numbers.size(), 5U);
  EXPECT_EQ(pool.replicate_numbers()[0], 0U);
}

// The errors of two replicates of an entry, over the shifts of many pixels: independent. The
// integrand is smooth, as a pixel's is where no edge is seen; its mean is 1.
TEST(SobolPool, ErrorsOfReplicatesDoNotGoTogether) {
  constexpr int kEntries = 32, kPixels = 2000, kPoints = 8;
  const SobolPool pool(3, kPoints, 0, 7, 0, kEntries);
  std::mt19937_64 random{5};
  const auto word = [&] { return static_cast<std::uint32_t>(random()); };
  const auto chi_square = [&](int one, int other, bool second) {
    double sum = 0;
    for (int entry = 0; entry < kEntries; ++entry) {
      double product = 0, squares[2] = {};
      for (int pixel = 0; pixel < kPixels; ++pixel) {
        std::uint32_t shift[4], turn[4];
        for (int d = 0; d < 4; ++d) shift[d] = word(), turn[d] = second ? word() : 0;
        double error[2] = {};
        for (int k = 0; k < 2; ++k)
          for (int i = 0; i < kPoints; ++i) {
            const int at = kPoints * (k == 0 ? one : other) + i;
            double f = 1;
            for (int d = 0; d < 4; ++d) {
              const std::uint32_t own = shift[d] ^ (turn[d] * pool.replicate_numbers()[at]);
              f *= 0.5 + ((pool.fractions(entry, d)[at] ^ own) + 0.5) * 0x1p-32;
            }
            error[k] += (f - 1) / kPoints;
          }
        product += error[0] * error[1];
        for (int k = 0; k < 2; ++k) squares[k] += error[k] * error[k];
      }
      sum += kPixels * product * product / (squares[0] * squares[1]);
    }
    return sum;
  };
  // A chi-square of n degrees of freedom has the mean n and the variance 2 n.
  const double most = kEntries + 5 * std::sqrt(2.0 * kEntries);
  EXPECT_LT(chi_square(0, 1, true), most);
  EXPECT_LT(chi_square(1, 2, true), most);
  // That is what the second shift is for.
  EXPECT_GT(chi_square(0, 1, false), 3 * most);
}

}  // namespace
}  // namespace plenoflame::test::sobol_test
