// Prescriptions: shipped ones against what their sources print, imports against lenses given twice.
#include "plenoflame/scene/lens_file.h"

#include <cmath>
#include <fstream>
#include <iterator>

#include "plenoflame/base/error.h"
#include "plenoflame/optics/first_order.h"
#include "plenoflame/optics/surface_shape.h"
#include "plenoflame/scene/presets.h"
#include "plenoflame/scene/scene_file.h"
#include "plenoflame/scene/validate.h"
#include "support/approx.h"
#include "support/temporary_folder.h"

namespace plenoflame::test::lens_file_test {
namespace {

constexpr double kMm = 1e-3;

Scene lens_scene(const std::string& name, const std::string& more = "") {
  return parse_scene("[camera.lens]\npreset = \"" + name +
                         "\"\n[camera.sensor]\ncolumns = 10\nrows = 10\npixel_pitch = \"10 um\"\n"
                         "[camera.focus]\nobject_distance = \"2 m\"\n" +
                         more,
                     name)
      .scene;
}

TEST(LensPresets, HaveTheirPublishedFocalLengths) {
  struct Row {
    const char* name;
    double focal_length, back_focus, tolerance;
  };
  // Tolerances: the printed digits.
  const Row rows[] = {{"paper-singlet", 304.0987, 295.9014, 5e-7},
                      {"achromat-100mm", 100.0009, 92.7580, 1e-6},
                      {"double-gauss-100mm", 100.0038, 61.4875, 5e-6}};
  EXPECT_EQ(preset_names(PresetKind::lens).size(), std::size(rows) + 2);
  for (const Row& row : rows) {
    const Scene scene = lens_scene(row.name);
    EXPECT_TRUE(preset_description(PresetKind::lens, row.name).ends_with(".")) << row.name;
    const FirstOrder lens = first_order(scene.camera.lens);
    EXPECT_TRUE(relative(lens.focal_length, row.focal_length * kMm, row.tolerance)) << row.name;
    EXPECT_TRUE(relative(lens.back_focal_distance, row.back_focus * kMm, row.tolerance))
        << row.name;
    for (const SceneIssue& issue : check_scene(scene))
      EXPECT_FALSE(issue.is_error) << row.name << ": " << issue.message;
  }
}

/// The most that rounding of all printed numbers may change: by differences.
/// @param length, index half of the last printed decimal
double rounding(const MainLensSpec& lens, double FirstOrder::*figure, double length, double index) {
  double sum = 0;
  const auto add = [&](double SurfaceSpec::*number, std::size_t i, double rounded) {
    MainLensSpec changed = lens;
    changed.surfaces[i].*number += 1e-3 * rounded;
    sum += 1e3 * std::fabs(first_order(changed).*figure - first_order(lens).*figure);
  };
  for (std::size_t i = 0; i < lens.surfaces.size(); ++i) {
    if (std::isfinite(lens.surfaces[i].radius)) add(&SurfaceSpec::radius, i, length);
    if (i + 1 == lens.surfaces.size()) continue;
    add(&SurfaceSpec::thickness, i, length);
    if (lens.surfaces[i].index != 1) add(&SurfaceSpec::index, i, index);
  }
  return sum;
}

TEST(LensPresets, Objective50) {
  // USP 3,552,829, example 1: f = 1, lengths to four decimals of it, indices to five.
  const Scene scene = lens_scene("objective-50mm");
  const FirstOrder f = first_order(scene.camera.lens);
  const double efl =
      rounding(scene.camera.lens, &FirstOrder::focal_length, 0.5e-4 * 50 * kMm, 0.5e-5);
  EXPECT_TRUE(within(f.focal_length, 50 * kMm, efl, 1));
  EXPECT_LT(efl, 2e-3 * f.focal_length);
  // The back focus has not been published: by another program.
  EXPECT_TRUE(relative(f.focal_length, 49.99886197452948 * kMm, 1e-12));
  EXPECT_TRUE(relative(f.back_focal_distance, 36.682034139208675 * kMm, 1e-12));
  for (const SceneIssue& issue : check_scene(scene)) EXPECT_FALSE(issue.is_error) << issue.message;
}

TEST(LensPresets, Objective100) {
  // USP 2,601,805 as printed by Smith (1992), p. 305: EFL 100.4, BFL 55.066 mm. To the last digit.
  const Scene scene = lens_scene("objective-100mm");
  const FirstOrder f = first_order(scene.camera.lens);
  EXPECT_TRUE(within(f.focal_length, 100.4 * kMm, 0.05 * kMm, 1));
  EXPECT_TRUE(within(f.back_focal_distance, 55.066 * kMm, 0.5e-3 * kMm, 1));
  for (const SceneIssue& issue : check_scene(scene)) EXPECT_FALSE(issue.is_error) << issue.message;
}

TEST(LensPresets, AchromatFollowsTheWavelength) {
  const auto back_focus = [](const std::string& wavelength) {
    return first_order(lens_scene("achromat-100mm",
                                  "[[channels]]\nname = \"a\"\nkind = \"band\"\nwavelength = \"" +
                                      wavelength + "\"\nwidth = \"1 nm\"\n")
                           .camera.lens)
        .back_focal_distance;
  };
  // From the coefficients by another program, mm.
  EXPECT_TRUE(relative(back_focus("486.1327 nm"), 92.74801106 * kMm, 1e-9));
  EXPECT_TRUE(relative(back_focus("656.2725 nm"), 92.82951362 * kMm, 1e-9));
  EXPECT_TRUE(relative(back_focus("587.5618 nm"), 92.75803600 * kMm, 1e-9));
}

TEST(LensImport, FourColumns) {
  const std::string text =
      "# D-GAUSS F/2 sample\n# radius thickness index diameter\n"
      "56.20238 8.75 1.622292 66\n152.28580 0.5 1 66\n37.68262 12.5 1.607379 56\n"
      "1e9 3.8 1.603417 56\n24.2313 16.369445 1.0 42\n0 13.747957 0 34.4\n"
      "-28.37731 3.8 1.603417 46\n-1e9\t11 1.620408 56\r\n-37.92546 0.5 1 56\n"
      "177.41176 7 1.620408 66\n-79.41143 61.487536 1 66\n";
  const LensFile file = import_four_columns(text, "a.dat");
  EXPECT_EQ(file.title, "D-GAUSS F/2 sample");
  ASSERT_EQ(file.lens.surfaces.size(), 11u);
  EXPECT_TRUE(file.lens.surfaces[5].stop);
  EXPECT_EQ(file.lens.surfaces[0].radius, 56.20238e-3);
  EXPECT_EQ(file.image_distance, 61.487536e-3);
  const FirstOrder lens = first_order(file.lens);
  EXPECT_TRUE(relative(lens.focal_length, 100.0038 * kMm, 1e-5));
  EXPECT_TRUE(relative(lens.back_focal_distance, 61.4875 * kMm, 1e-5));
}

const char* const kZmx =
    "VERS 140124 258 36214\nMODE SEQ\nNAME A doublet\nUNIT MM X W X CM MR CPMM\n"
    "SURF 0\n  TYPE STANDARD\n  CURV 0.0 0 0 0 0 \"\"\n  DISZ INFINITY\n  DIAM 0 0 0 0 1 \"\"\n"
    "SURF 1\n  STOP\n  TYPE STANDARD\n  CURV 1.932292471788530E-02 0 0 0 0 \"\"\n  COAT AR\n"
    "  DISZ 9\n  GLAS N-BK7 0 0 1.5168 64.17\n  DIAM 13.5 1 0 0 1 \"\"\n"
    "SURF 2\n  TYPE EVENASPH\n  CURV -2.233289411974898E-02 0\n  PARM 1 0\n  PARM 2 1.5E-7\n"
    "  PARM 4 -2e-13\n  CONI -0.4\n  DISZ 3\n  GLAS SF2 0 0 1.64769 33.85\n  DIAM 13.5 1 0\n"
    "SURF 3\n  TYPE STANDARD\n  CURV -4.600281537230078E-03 0\n  DISZ 92.75\n  DIAM 13.5 1 0\n"
    "SURF 4\n  TYPE STANDARD\n  CURV 0\n  DISZ 0\n  DIAM 10\nTOL TOFF 0 0\n";

TEST(LensImport, Zemax) {
  const LensFile file = import_zmx(kZmx, "a.zmx");
  EXPECT_EQ(file.title, "A doublet");
  ASSERT_EQ(file.lens.surfaces.size(), 3u);
  EXPECT_TRUE(file.notes.empty());
  const auto& s = file.lens.surfaces;
  EXPECT_TRUE(relative(s[0].radius, 51.752 * kMm, 1e-14));
  EXPECT_TRUE(s[0].stop);
  EXPECT_EQ(s[0].glass, "N-BK7");
  EXPECT_TRUE(relative(s[0].diameter, 27 * kMm, 1e-15));
  EXPECT_EQ(s[1].conic, -0.4);
  ASSERT_EQ(s[1].aspheric.size(), 3u);
  EXPECT_TRUE(relative(s[1].aspheric[0], 1.5e-7 * 1e9, 1e-14));
  EXPECT_EQ(s[1].aspheric[1], 0);
  EXPECT_TRUE(relative(s[1].aspheric[2], -2e-13 * 1e21, 1e-14));
  EXPECT_TRUE(relative(file.image_distance, 92.75 * kMm, 1e-14));
  EXPECT_TRUE(relative(first_order(file.lens).focal_length, 100.0009 * kMm, 1e-6));
}

// Zemax has y in CURV and CONI, x in PARM; 0 is a plane.
TEST(LensImport, ZemaxBiconics) {
  std::string text = kZmx;
  const std::string from = "TYPE EVENASPH", parm = "PARM 2 1.5E-7\n  PARM 4 -2e-13";
  text.replace(text.find(from), from.size(), "TYPE BICONICX");
  text.replace(text.find("PARM 1 0\n"), 9, "PARM 1 -31.5\n");
  text.replace(text.find(parm), parm.size(), "PARM 2 -1.25");
  const SurfaceSpec biconic = import_zmx(text, "a.zmx").lens.surfaces[1];
  EXPECT_TRUE(relative(biconic.radius_x, -31.5 * kMm, 1e-15));
  EXPECT_EQ(biconic.conic_x, -1.25);
  EXPECT_TRUE(relative(biconic.radius_y, kMm / -2.233289411974898E-02, 1e-15));
  EXPECT_EQ(biconic.conic_y, -0.4);
  EXPECT_TRUE(std::isinf(biconic.radius));
  EXPECT_EQ(biconic.conic, 0);
  EXPECT_FALSE(surface_fault(biconic).has_value());
  // A cylinder: PARM 1 is 0, and so is no radius.
  text.replace(text.find("PARM 1 -31.5\n"), 13, "PARM 1 0\n");
  const SurfaceSpec cylinder = import_zmx(text, "a.zmx").lens.surfaces[1];
  EXPECT_TRUE(std::isinf(cylinder.radius_x));
  EXPECT_EQ(cylinder.conic_x, 0);
  EXPECT_FALSE(surface_fault(cylinder).has_value());
  // A flat one is the plane, in a round lens or not.
  text.replace(text.find("CURV -2.233289411974898E-02"), 27, "CURV 0");
  EXPECT_EQ(surface_sag(import_zmx(text, "a.zmx").lens.surfaces[1], {3 * kMm, 5 * kMm}), 0);
  text.replace(text.find("PARM 2 -1.25"), 12, "PARM 3 0.5");
  try {
    import_zmx(text, "a.zmx");
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("a.zmx:18: PARM 3 on a biconic"), std::string::npos)
        << error.what();
  }
}

TEST(LensImport, ZemaxInUtf16) {
  std::string wide("\xFF\xFE", 2);
  for (const char* c = kZmx; *c; ++c) wide.append(1, *c).append(1, '\0');
  EXPECT_EQ(import_zmx(wide, "a.zmx").lens, import_zmx(kZmx, "a.zmx").lens);
}

std::string zmx_error(const std::string& from, const std::string& to) {
  std::string text = kZmx;
  text.replace(text.find(from), from.size(), to);
  try {
    import_zmx(text, "a.zmx");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(LensImport, WhatZemaxFilesMayNotHave) {
  const auto expect = [](const std::string& message, const std::string& words) {
    EXPECT_NE(message.find(words), std::string::npos) << message;
  };
  expect(zmx_error("TYPE EVENASPH", "TYPE COORDBRK"), "a.zmx:19: surface type \"COORDBRK\"");
  expect(zmx_error("MODE SEQ", "MODE NSC"), "a.zmx:2: MODE NSC");
  expect(zmx_error("GLAS SF2 0 0 1.64769 33.85", "GLAS MIRROR 0 0 1.5 40"), "mirrors");
  expect(zmx_error("GLAS SF2 0 0 1.64769 33.85", "GLAS SF3"), "did you mean \"SF2\"");
  expect(zmx_error("PARM 1 0", "PARM 1 0.5"), "h^2");
  expect(zmx_error("COAT AR", "SQAP 1 2 0"), "SQAP is not supported");
  expect(zmx_error("COAT AR", "OBSC 0 2 0"), "OBSC is not supported");
  expect(zmx_error("COAT AR", "OBDC 1 2"), "OBDC is not supported");
  expect(zmx_error("TOL TOFF 0 0", "MNUM 3"), "several configurations");
  expect(zmx_error("DISZ 9", "DISZ nine"), "\"nine\" is not a number");
  expect(zmx_error("DISZ 9", "DISZ -9"), "negative thickness");
  expect(zmx_error("  DIAM 13.5 1 0 0 1 \"\"", "  DIAM 0"), "no clear aperture");
  expect(zmx_error("  DIAM 13.5 1 0 0 1 \"\"", "  DIAM 13500"), "curved too much");
  // The notes name everything that is replaced or unknown.
  std::string text = kZmx;
  text.replace(text.find("GLAS SF2"), 8, "GLAS XYZ");
  text.replace(text.find("COAT AR"), 7, "ABCD 12");
  const LensFile file = import_zmx(text, "a.zmx");
  ASSERT_EQ(file.notes.size(), 2u);
  EXPECT_NE(file.notes[0].find("a.zmx:14"), std::string::npos);
  EXPECT_NE(file.notes[1].find("not in the catalogue"), std::string::npos);
  EXPECT_TRUE(relative(file.lens.surfaces[1].index, 1.64769, 1e-12));
}

TEST(LensImport, FourColumnErrors) {
  const std::pair<const char*, const char*> cases[] = {
      {"1 2 3", "3 columns"},
      {"1 2 1.5 x", "\"x\" is not a number"},
      {"", "no surface"},
      {"10 1 0.3 5", "the index is 0.3"},
      {"10 -1 1.5 5", "thickness is negative"},
      {"10 1 1.5 0", "not positive"},
      {"10 1 1.5 20.1\n0 1 0 5\n-10 9 1 5", "a.dat:1: a sphere of this radius"},
      {"10 1 1.5 5\n-10 9 1 5", "no aperture stop"},
      {"0 1 0 5\n10 1 1.5 5\n-10 9 1.4 5", "that of air"}};
  for (const auto& [text, words] : cases) {
    std::string message;
    try {
      import_four_columns(text, "a.dat");
    } catch (const InputError& error) {
      message = error.what();
    }
    EXPECT_NE(message.find(words), std::string::npos) << text << ": " << message;
  }
}

TEST(LensFiles, InAScene) {
  const TemporaryFolder folder;
  const auto put = [&](const std::string& name, const std::string& text) {
    std::ofstream(folder.file(name)) << text;
  };
  put("a.zmx", kZmx);
  const std::string scene = "[camera.lens]\nfile = \"FILE\"\nmodel = \"ideal\"\n";
  const auto read = [&](const std::string& file) {
    std::string text = scene;
    text.replace(text.find("FILE"), 4, file);
    put("scene.toml", text);
    return read_scene_file(folder.file("scene.toml")).scene.camera.lens;
  };
  const MainLensSpec lens = read("a.zmx");
  EXPECT_EQ(lens.surfaces, import_zmx(kZmx, "").lens.surfaces);
  EXPECT_EQ(lens.model, LensModel::ideal);  // keys beside the file override it
  // As TOML and back, bit for bit.
  put("b.toml", write_lens(import_zmx(kZmx, "").lens));
  EXPECT_EQ(read("b.toml"), lens);
  put("loop.toml", "[camera.lens]\nfile = \"loop.toml\"\n");
  EXPECT_THROW(read("loop.toml"), InputError);
  EXPECT_THROW(read("none.zmx"), FileError);
  EXPECT_THROW(read("a.png"), InputError);
}

TEST(LensFiles, UnknownGlassIsReportedWithItsPlace) {
  try {
    parse_scene(
        "[[camera.lens.surfaces]]\nradius = \"1 m\"\nglass = \"N-BK8\"\ndiameter = \"1 mm\"\n",
        "a.toml");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(error.position().line, 3);
    EXPECT_NE(std::string(error.what()).find("N-BK7"), std::string::npos);
  }
}

}  // namespace
}  // namespace plenoflame::test::lens_file_test
