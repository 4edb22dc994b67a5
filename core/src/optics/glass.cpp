#include "plenoflame/optics/glass.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <vector>

#include "plenoflame/base/error.h"

namespace plenoflame {
namespace {

constexpr std::string_view kSchott = "Schott data sheets";

// Ranges of wavelengths: Schott's catalogue of 2017-01-20, and the ranges of Malitson's
// measurements.

constexpr CatalogueGlass kCatalogue[] = {
    {"CAF2",
     {0.5675888, 0.4710914, 3.8484723},
     {0.00252642999, 0.01007833276, 1200.5559729},
     {0.23, 9.7},
     1.43385,
     95.00,
     "Malitson, Appl. Opt. 2 (1963), 1103"},
    {"F2",
     {1.34533359, 0.209073176, 0.937357162},
     {0.00997743871, 0.0470450767, 111.886764},
     {0.32, 2.5},
     1.62004,
     36.37,
     kSchott},
    {"LF5",
     {1.28035628, 0.163505973, 0.893930112},
     {0.00929854416, 0.0449135769, 110.493685},
     {0.32, 2.325},
     1.58144,
     40.85,
     kSchott},
    {"N-BAF10",
     {1.5851495, 0.143559385, 1.08521269},
     {0.00926681282, 0.0424489805, 105.613573},
     {0.35, 2.5},
     1.67003,
     47.11,
     kSchott},
    {"N-BAK1",
     {1.12365662, 0.309276848, 0.881511957},
     {0.00644742752, 0.0222284402, 107.297751},
     {0.3, 2.5},
     1.57250,
     57.55,
     kSchott},
    {"N-BAK4",
     {1.28834642, 0.132817724, 0.945395373},
     {0.00779980626, 0.0315631177, 105.965875},
     {0.334, 2.5},
     1.56883,
     55.98,
     kSchott},
    {"N-BALF4",
     {1.31004128, 0.142038259, 0.964929351},
     {0.0079659645, 0.0330672072, 109.19732},
     {0.35, 2.5},
     1.57956,
     53.87,
     kSchott},
    {"N-BK7",
     {1.03961212, 0.231792344, 1.01046945},
     {0.00600069867, 0.0200179144, 103.560653},
     {0.3, 2.5},
     1.51680,
     64.17,
     kSchott},
    {"N-F2",
     {1.39757037, 0.159201403, 1.2686543},
     {0.00995906143, 0.0546931752, 119.248346},
     {0.365, 2.5},
     1.62005,
     36.43,
     kSchott},
    {"N-FK5",
     {0.844309338, 0.344147824, 0.910790213},
     {0.00475111955, 0.0149814849, 97.8600293},
     {0.26, 2.5},
     1.48749,
     70.41,
     kSchott},
    {"N-FK51A",
     {0.971247817, 0.216901417, 0.904651666},
     {0.00472301995, 0.0153575612, 168.68133},
     {0.29, 2.5},
     1.48656,
     84.47,
     kSchott},
    {"N-K5",
     {1.08511833, 0.199562005, 0.930511663},
     {0.00661099503, 0.024110866, 111.982777},
     {0.31, 2.5},
     1.52249,
     59.48,
     kSchott},
    {"N-LAF2",
     {1.80984227, 0.15729555, 1.0930037},
     {0.0101711622, 0.0442431765, 100.687748},
     {0.35, 2.5},
     1.74397,
     44.85,
     kSchott},
    {"N-LAK22",
     {1.14229781, 0.535138441, 1.04088385},
     {0.00585778594, 0.0198546147, 100.834017},
     {0.31, 2.5},
     1.65113,
     55.89,
     kSchott},
    {"N-LAK9",
     {1.46231905, 0.344399589, 1.15508372},
     {0.00724270156, 0.0243353131, 85.4686868},
     {0.3, 2.5},
     1.69100,
     54.71,
     kSchott},
    {"N-LASF44",
     {1.78897105, 0.38675867, 1.30506243},
     {0.00872506277, 0.0308085023, 92.7743824},
     {0.334, 2.5},
     1.80420,
     46.50,
     kSchott},
    {"N-PSK53A",
     {1.38121836, 0.196745645, 0.886089205},
     {0.00706416337, 0.0233251345, 97.4847345},
     {0.32, 2.5},
     1.61800,
     63.39,
     kSchott},
    {"N-SF10",
     {1.62153902, 0.256287842, 1.64447552},
     {0.0122241457, 0.0595736775, 147.468793},
     {0.38, 2.5},
     1.72828,
     28.53,
     kSchott},
    {"N-SF11",
     {1.73759695, 0.313747346, 1.89878101},
     {0.013188707, 0.0623068142, 155.23629},
     {0.37, 2.5},
     1.78472,
     25.68,
     kSchott},
    {"N-SF5",
     {1.52481889, 0.187085527, 1.42729015},
     {0.011254756, 0.0588995392, 129.141675},
     {0.37, 2.5},
     1.67271,
     32.25,
     kSchott},
    {"N-SF6",
     {1.77931763, 0.338149866, 2.08734474},
     {0.0133714182, 0.0617533621, 174.01759},
     {0.37, 2.5},
     1.80518,
     25.36,
     kSchott},
    {"N-SK14",
     {0.936155374, 0.594052018, 1.04374583},
     {0.00461716525, 0.016885927, 103.736265},
     {0.31, 2.5},
     1.60311,
     60.60,
     kSchott},
    {"N-SK16",
     {1.34317774, 0.241144399, 0.994317969},
     {0.00704687339, 0.0229005, 92.7508526},
     {0.31, 2.5},
     1.62041,
     60.32,
     kSchott},
    {"N-SK2",
     {1.28189012, 0.257738258, 0.96818604},
     {0.0072719164, 0.0242823527, 110.377773},
     {0.31, 2.5},
     1.60738,
     56.65,
     kSchott},
    {"N-SSK8",
     {1.44857867, 0.117965926, 1.06937528},
     {0.00869310149, 0.0421566593, 111.300666},
     {0.35, 2.5},
     1.61773,
     49.83,
     kSchott},
    {"SF10",
     {1.61625977, 0.259229334, 1.07762317},
     {0.0127534559, 0.0581983954, 116.60768},
     {0.38, 2.5},
     1.72825,
     28.41,
     kSchott},
    {"SF11",
     {1.73848403, 0.311168974, 1.17490871},
     {0.0136068604, 0.0615960463, 121.922711},
     {0.39, 2.5},
     1.78472,
     25.76,
     kSchott},
    {"SF2",
     {1.40301821, 0.231767504, 0.939056586},
     {0.0105795466, 0.0493226978, 112.405955},
     {0.35, 2.5},
     1.64769,
     33.85,
     kSchott},
    {"SF5",
     {1.46141885, 0.247713019, 0.949995832},
     {0.0111826126, 0.0508594669, 112.041888},
     {0.35, 2.5},
     1.67270,
     32.21,
     kSchott},
    {"SF57",
     {1.81651371, 0.428893641, 1.07186278},
     {0.0143704198, 0.0592801172, 121.419942},
     {0.37, 2.5},
     1.84666,
     23.83,
     kSchott},
    {"SF6",
     {1.72448482, 0.390104889, 1.04572858},
     {0.0134871947, 0.0569318095, 118.557185},
     {0.365, 2.5},
     1.80518,
     25.43,
     kSchott},
    {"FUSED-SILICA",
     {0.6961663, 0.4079426, 0.8974794},
     {0.00467914826, 0.0135120631, 97.9340025},
     {0.21, 3.71},
     1.45846,
     67.82,
     "Malitson, J. Opt. Soc. Am. 55 (1965), 1205"},
};

/// Other names of the same glass, or of the one that replaced it.
constexpr std::string_view kAliases[][2] = {{"BK7", "N-BK7"},
                                            {"SILICA", "FUSED-SILICA"},
                                            {"F_SILICA", "FUSED-SILICA"},
                                            {"QUARTZ", "FUSED-SILICA"},
                                            {"SK16", "N-SK16"},
                                            {"BAK4", "N-BAK4"},
                                            {"FK5", "N-FK5"},
                                            {"K5", "N-K5"}};

std::string upper(std::string_view text) {
  std::string result;
  for (const char c : text)
    result += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return result;
}

std::vector<std::string_view> words_of(std::string_view text) {
  std::vector<std::string_view> words;
  while (true) {
    const auto begin = text.find_first_not_of(' ');
    if (begin == std::string_view::npos) return words;
    text.remove_prefix(begin);
    const auto end = std::min(text.find(' '), text.size());
    words.push_back(text.substr(0, end));
    text.remove_prefix(end);
  }
}

std::vector<double> numbers(std::string_view text, const std::vector<std::string_view>& words,
                            std::size_t count) {
  std::vector<double> values;
  for (std::size_t i = 1; i < words.size(); ++i) {
    double value = 0;
    const char* end = words[i].data() + words[i].size();
    const auto [at, error] = std::from_chars(words[i].data(), end, value);
    if (error == std::errc() && at == end && std::isfinite(value)) values.push_back(value);
  }
  if (values.size() != count || words.size() != count + 1)
    throw InputError("glass \"" + std::string(text) + "\": " + std::string(words.front()) +
                     " is followed by " + std::to_string(count) + " number" +
                     (count == 1 ? "" : "s"));
  return values;
}

std::size_t edits(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t changed = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({changed, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row.back();
}

/// As the catalogue spells it: "fused silica" is as good as "FUSED-SILICA".
std::string catalogue_name(const std::vector<std::string_view>& words) {
  std::string name;
  for (const std::string_view word : words) {
    if (!name.empty()) name += '-';
    name += upper(word);
  }
  for (const auto& alias : kAliases)
    if (name == alias[0]) name = alias[1];
  return name;
}

}  // namespace

std::span<const CatalogueGlass> glass_catalogue() {
  return kCatalogue;
}

const CatalogueGlass* find_catalogue_glass(std::string_view text) {
  const std::string name = catalogue_name(words_of(text));
  for (const CatalogueGlass& glass : glass_catalogue())
    if (glass.name == name) return &glass;
  return nullptr;
}

Glass::Glass(std::string_view text) {
  const auto words = words_of(text);
  if (words.empty()) throw InputError("the name of a glass is empty");
  const std::string first = upper(words.front());
  if (first == "CONSTANT") {
    values_[0] = numbers(text, words, 1)[0];
    if (!(values_[0] >= 1))
      throw InputError("glass \"" + std::string(text) + "\": an index is at least 1");
    return;
  }
  if (first == "ABBE") {
    const auto given = numbers(text, words, 2);
    if (!(given[0] > 1) || !(given[1] > 0))
      throw InputError("glass \"" + std::string(text) +
                       "\": the index must be above 1, the Abbe number positive");
    kind_ = Kind::cauchy;
    // (nd - 1) / (nF - nC) = vd.
    const double f = 1 / (kLineF * kLineF), c = 1 / (kLineC * kLineC);
    values_[1] = (given[0] - 1) / given[1] / (f - c);
    values_[0] = given[0] - values_[1] / (kLineD * kLineD);
    return;
  }
  kind_ = Kind::sellmeier;
  if (first == "SELLMEIER") {
    const auto given = numbers(text, words, 6);
    std::copy(given.begin(), given.end(), values_);
    return;
  }
  const std::string name = catalogue_name(words);
  const CatalogueGlass* nearest = nullptr;
  std::size_t least = 0;
  for (const CatalogueGlass& glass : glass_catalogue()) {
    const std::size_t distance = edits(name, glass.name);
    if (!nearest || distance < least) nearest = &glass, least = distance;
  }
  if (least > 0)
    throw InputError(
        "there is no glass \"" + std::string(text) + "\" in the catalogue; did you mean \"" +
        std::string(nearest->name) +
        "\"? Others can be given as \"sellmeier B1 B2 B3 C1 C2 C3\" or \"abbe nd vd\"");
  std::copy(nearest->b, nearest->b + 3, values_);
  std::copy(nearest->c, nearest->c + 3, values_ + 3);
}

double Glass::index(double wavelength) const {
  if (!(wavelength > 0)) throw InputError("a wavelength must be positive");
  if (kind_ == Kind::constant) return values_[0];
  if (kind_ == Kind::cauchy) return values_[0] + values_[1] / (wavelength * wavelength);
  const double um2 = 1e12 * wavelength * wavelength;
  double square = 1;
  bool transparent = true;
  for (int i = 0; i < 3; ++i) {
    const double resonance = values_[i + 3];
    square += values_[i] * um2 / (um2 - resonance);
    // Between the resonances in the ultraviolet and those in the infrared.
    transparent = transparent && (resonance < 1 ? um2 > resonance : um2 < resonance);
  }
  if (!transparent || !(square >= 1) || !std::isfinite(square))
    throw InputError("a glass has no index at the wavelength of " +
                     std::to_string(1e9 * wavelength) + " nm: its formula does not hold there");
  return std::sqrt(square);
}

}  // namespace plenoflame
