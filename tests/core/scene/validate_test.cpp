#include "plenoflame/scene/validate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>

#include "plenoflame/scene/scene_file.h"
#include "scene/validation/issues.h"
#include "scene_samples.h"
#include "support/approx.h"

namespace plenoflame::validate_test {
namespace {

using test::message_of;

constexpr const char* kScene =
    "[camera]\npreset = \"paper-plenoptic2\"\n"
    "[[flames]]\npreset = \"paper-layered\"\nposition = [\"1 m\", \"0 m\", \"-29 mm\"]\n";

Scene sound() {
  return parse_scene(kScene, "").scene;
}

/// The first error after a change of a sound scene.
std::string error_after(const std::function<void(Scene&)>& change) {
  Scene scene = sound();
  change(scene);
  return message_of([&] { validate(scene); });
}

/// The only warning after a change of a sound scene.
std::string warning_after(const std::function<void(Scene&)>& change) {
  Scene scene = sound();
  change(scene);
  const auto warnings = validate(scene);
  return warnings.size() == 1 ? warnings[0].message : std::to_string(warnings.size()) + " warnings";
}

TEST(Validate, SoundSceneHasNoIssues) {
  EXPECT_TRUE(validate(sound()).empty());
}

/// A flame of a file with one emission line, seen by one band.
void with_line(Scene& scene, const LineSpec& line, double band = 431.54e-9) {
  FlameSpec flame;
  flame.kind = FlameKind::vdb;
  flame.file = "flame.vdb";
  flame.lines = {line};
  scene.flames = {flame};
  scene.channels = {{"band", ChannelKind::band, band, 10e-9}};
}

TEST(Validate, EmissionLines) {
  const auto error = [](const LineSpec& line) {
    return error_after([&](Scene& s) { with_line(s, line); });
  };
  EXPECT_EQ(error({LineKind::ch}), "");
  EXPECT_NE(error({}).find("flames[0].lines[0] needs a wavelength"), std::string::npos);
  EXPECT_NE(error({LineKind::custom, 431e-9}).find("needs a grid"), std::string::npos);
  EXPECT_NE(error({LineKind::ch, 0, 300e-9}).find("width below a quarter"), std::string::npos);
  EXPECT_NE(error({LineKind::ch, 0, 0, {"g", "W/m^2"}})
                .find("flames[0].lines[0].unit is \"W/m^2\"; it must be one of W/m^3, kW/m^3"),
            std::string::npos);
  const auto warning = [](const LineSpec& line, double band) {
    return warning_after([&](Scene& s) { with_line(s, line, band); });
  };
  EXPECT_EQ(warning({LineKind::ch}, 650e-9),
            "flames[0].lines[0] is at 431.5 nm, which no channel sees; add a channel, such as kind "
            "= \"band\" around it");
  EXPECT_NE(warning({LineKind::ch, 500e-9}, 431e-9).find("wavelength is not used"),
            std::string::npos);
  // Soot whose index is known from 0.4 um on only.
  EXPECT_NE(error_after([](Scene& s) {
              with_line(s, {LineKind::oh}, 309e-9);
              s.flames[0].spectrum.kind = SpectrumKind::soot;
              s.flames[0].spectrum.index = SootIndexSource::chang;
            }).find("is at 309 nm, where the flame's absorption is not known"),
            std::string::npos);
  EXPECT_NE(error_after([](Scene& s) {
              s.flames[0].lines = {{LineKind::ch}};
            }).find("the flame is layered"),
            std::string::npos);
}

TEST(Validate, EmissionLinesThatCountTheSameGridTwice) {
  const auto warning = [](const LineSpec& first, const LineSpec& second) {
    return warning_after([&](Scene& s) {
      with_line(s, first, 516.66e-9);
      s.channels[0].width = 200e-9;
      s.flames[0].lines.push_back(second);
    });
  };
  const std::string twice =
      "flames[0].lines[1] reads the same grid as flames[0].lines[0], so its light counts twice; "
      "give each its own grid, or a scale";
  EXPECT_EQ(warning({LineKind::c2_474}, {LineKind::c2_517}), twice);
  EXPECT_EQ(warning({LineKind::c2_517, 0, 0, {"g"}}, {LineKind::ch, 0, 0, {"g"}}), twice);
  EXPECT_EQ(warning({LineKind::ch}, {LineKind::ch}), twice);
  EXPECT_EQ(warning({LineKind::c2_564}, {LineKind::c2_474}), twice);
  EXPECT_EQ(warning({LineKind::ch}, {LineKind::c2_517}), "0 warnings");
  EXPECT_EQ(warning({LineKind::c2_474, 0, 0, {"a"}}, {LineKind::c2_517}), "0 warnings");
  LineSpec third{LineKind::c2_517};
  third.emission.scale = 0.3;
  EXPECT_EQ(warning({LineKind::c2_474}, third), "0 warnings");
  // The second and the third of three are named, once each.
  EXPECT_EQ(warning_after([](Scene& s) {
              with_line(s, {LineKind::ch});
              s.flames[0].lines.resize(3, {LineKind::ch});
            }),
            "2 warnings");
}

TEST(Validate, GridsOfAlbedos) {
  const auto error = [](FlameKind kind, double albedo) {
    return error_after([&](Scene& s) {
      with_line(s, {LineKind::ch});
      s.flames[0].kind = kind;
      s.flames[0].scattering.grid = "omega";
      s.flames[0].scattering.albedo = albedo;
    });
  };
  EXPECT_EQ(error(FlameKind::vdb, 0), "");
  EXPECT_NE(error(FlameKind::vdb, 0.5).find("albedo are both given"), std::string::npos);
  EXPECT_NE(error_after([](Scene& s) {
              s.flames[0].scattering.grid = "omega";
            }).find("flames[0].scattering.grid is a grid of a file"),
            std::string::npos);
}

// Each glass has a range of its own: the indices of N-SF11 are published from 370 nm on, those of
// N-FK5 from 260 nm. What a sensor's response has left there does not count.
TEST(Validate, GlassesAreKnownWithinTheirRange) {
  const auto error = [](const char* glass, const ChannelSpec& channel) {
    return error_after([&](Scene& s) {
      s.camera.lens.surfaces[0].glass = glass;
      s.channels = {channel};
    });
  };
  const ChannelSpec violet{"violet", ChannelKind::band, 360e-9, 10e-9};
  const ChannelSpec ultraviolet{"uv", ChannelKind::band, 280e-9, 10e-9};
  EXPECT_EQ(error("N-FK5", violet), "");
  EXPECT_EQ(error("N-FK5", ultraviolet), "");
  EXPECT_EQ(
      error("n-sf11", violet),
      "channel \"violet\" reaches from 355 nm to 365 nm, but the index of glass \"N-SF11\" is "
      "known from 370 nm to 2.5 um only; choose another band, or give an index");
  EXPECT_NE(error("BK7", ultraviolet).find("glass \"N-BK7\" is known from 300 nm"),
            std::string::npos);
  EXPECT_EQ(error("N-SF11", {"x", ChannelKind::named, 0, 0, "cie_x"}), "");
  EXPECT_NE(error("N-SF11", {"b", ChannelKind::band, 372e-9, 20e-9}).find("N-SF11"),
            std::string::npos);
}

// The command `info` validates only: what a filter leaves nothing of must not wait for `render`.
TEST(Validate, FiltersThatPassNothing) {
  const auto error = [](const char* filter) {
    return error_after([&](Scene& s) {
      s.channels = {{"red", ChannelKind::band, 650e-9, 10e-9}};
      s.camera.transmission.filter = filter;
    });
  };
  EXPECT_EQ(error("600 nm 1, 650 nm 1"), "");
  EXPECT_NE(error("400 nm 1, 500 nm 1").find("channel \"red\": the filter"), std::string::npos);
  EXPECT_NE(error("400 nm 1, 500 nm 1").find("lets nothing through"), std::string::npos);
  // A filter that is 0 all over the channel:
  EXPECT_NE(error("400 nm 1, 500 nm 0, 700 nm 0").find("lets nothing through"), std::string::npos);
}

TEST(Validate, SagIsThatOfTheCircle) {
  // mpmath, 30 digits: R - sqrt(R^2 - h^2).
  EXPECT_TRUE(test::relative(sag(0.3, 0.06), 6.06123086601863e-3, 1e-14));
  EXPECT_TRUE(test::relative(sag(-0.3, 0.06), -6.06123086601863e-3, 1e-14));
  EXPECT_TRUE(test::relative(sag(1e6, 1e-3), 5.00000000000000000125e-13, 1e-14));
  EXPECT_EQ(sag(2.0, 2.0), 2.0);
  EXPECT_EQ(sag(kInfinity, 1.0), 0.0);
}

TEST(Validate, MainLens) {
  EXPECT_EQ(error_after([](Scene& s) { s.camera.lens.surfaces.clear(); }),
            "the main lens has no surfaces; list them as [[camera.lens.surfaces]], or set "
            "camera.lens.model = "
            "\"ideal\" with focal_length and diameter");
  EXPECT_EQ(error_after([](Scene& s) { s.camera.lens.surfaces[2].stop = false; }),
            "no surface of the main lens is the stop; set stop = true on one of them");
  EXPECT_EQ(error_after([](Scene& s) { s.camera.lens.surfaces[0].stop = true; }),
            "surfaces 0 and 2 of the main lens are both the stop; only one can be");
  EXPECT_EQ(error_after([](Scene& s) { s.camera.lens.surfaces[0].diameter = 0.61; }),
            "surface 0 of the main lens has a diameter of 610 mm, but a sphere of radius 300 mm "
            "allows at most 600 mm");
  // Both faces are 6.0612 mm deep at the rim: 12.122 mm are needed, 24.26 mm there.
  EXPECT_EQ(error_after([](Scene& s) { s.camera.lens.surfaces[0].thickness = 0.0121; }),
            "surfaces 0 and 1 of the main lens overlap by 22.46 um at their common rim, 60 mm from "
            "the axis; make the "
            "thickness 12.12 mm or more, or a diameter smaller");
  EXPECT_EQ(error_after([](Scene& s) { s.camera.lens.surfaces[0].thickness = 0.012123; }), "");
  // Only as far out as both surfaces reach.
  EXPECT_EQ(error_after([](Scene& s) {
              s.camera.lens.surfaces[0].thickness = 0.0121;
              s.camera.lens.surfaces[1].diameter = 0.1;
            }),
            "");
  EXPECT_EQ(
      error_after([](Scene& s) { s.camera.lens.surfaces[2].index = 1.5; }),
      "the index behind the last surface of the main lens must be 1: the light leaves it into air");
  EXPECT_EQ(error_after([](Scene& s) {
              s.camera.lens.surfaces[0].radius = -0.3;
              s.camera.lens.surfaces[1].radius = 0.3;
              s.camera.lens.surfaces[1].thickness = 0.005;
            }).substr(0, 53),
            "the main lens does not converge, so it forms no image");
  EXPECT_NE(error_after([](Scene& s) { s.camera.lens.surfaces[0].index = 0.99; }), "");
  EXPECT_EQ(error_after([](Scene& s) { s.camera.lens.surfaces[1].diameter = 0; }),
            "camera.lens.surfaces[1].diameter is missing; above 0 m, at most 100 m is allowed");
  EXPECT_EQ(error_after([](Scene& s) { s.camera.lens.surfaces[1].radius = std::nan(""); }),
            "camera.lens.surfaces[1].radius: a length is not a number (NaN)");
  EXPECT_NE(error_after([](Scene& s) {
              s.camera.lens = {};
              s.camera.lens.model = LensModel::ideal;
              s.camera.lens.diameter = 0.1;
            }).find("camera.lens.focal_length"),
            std::string::npos);
  const auto with_stop_of = [](double d) {
    return warning_after([&](Scene& s) { s.camera.lens.surfaces[2].diameter = d; });
  };
  EXPECT_NE(with_stop_of(0.5).find("the stop of the main lens is 500 mm wide"), std::string::npos);
  EXPECT_EQ(with_stop_of(0.01), "0 warnings");
  EXPECT_NE(warning_after([](Scene& s) { s.camera.lens.focal_length = 0.3; }).find("not used"),
            std::string::npos);
}

TEST(Validate, Orientation) {
  EXPECT_NE(error_after([](Scene& s) {
              s.camera.look_direction = {0, 0, 0};
            }).find("camera.look_direction"),
            std::string::npos);
  EXPECT_NE(error_after([](Scene& s) {
              s.camera.up = {-3, 0, 0};
            }).find("parallel"),
            std::string::npos);
}

TEST(Validate, Array) {
  EXPECT_EQ(error_after([](Scene& s) { s.camera.array.pitch = 0.9e-4; }),
            "the microlenses have a diameter of 100 um at a pitch of 90 um, so they overlap; make "
            "the diameter at most "
            "the pitch");
  EXPECT_EQ(error_after([](Scene& s) { s.camera.array.types.clear(); }),
            "the microlens array has 0 types; list 1 to 3 as [[camera.array.types]]");
  EXPECT_EQ(error_after([](Scene& s) {
              s.camera.array.types.resize(4, {"d", 1e-3, 1e-3, 1.5, 0});
            }),
            "camera.array.types has 4 items; 0 to 3 are allowed");
  EXPECT_EQ(error_after([](Scene& s) { s.camera.array.types[2].name = "type1"; }),
            "microlens types 0 and 2 are both named \"type1\"; names must differ");
  EXPECT_EQ(error_after([](Scene& s) { s.camera.array.types[2].name.clear(); }),
            "microlens type 2 has no name");
  EXPECT_NE(error_after([](Scene& s) { s.camera.array.types[2].name = "sensor"; }), "");
  EXPECT_EQ(error_after([](Scene& s) { s.camera.array.types[1].radius_back = 4.9e-5; }),
            "microlens type 1 has a radius_back of 49 um, too small for the diameter of 100 um");
  // 2 * (0.225 - sqrt(0.225^2 - 0.05^2)) mm = 11.253 um.
  EXPECT_EQ(error_after([](Scene& s) { s.camera.array.thickness = 11.2e-6; }),
            "the faces of microlens type 0 overlap at its rim; a thickness of at least 11.25 um is "
            "needed");
  EXPECT_EQ(error_after([](Scene& s) { s.camera.array.thickness = 11.3e-6; }), "");
  EXPECT_EQ(error_after([](Scene& s) { s.camera.array.sensor_distance = 0; }),
            "camera.array.sensor_distance is missing; above 0 m, at most 10 m is allowed");
  // The principal plane lies 17.3077 um inside (closed form of the symmetric thick lens).
  EXPECT_EQ(error_after([](Scene& s) { s.camera.array.sensor_distance = 17.3e-6; }).substr(0, 50),
            "the sensor would lie inside the microlenses, -7.69");
  EXPECT_EQ(error_after([](Scene& s) { s.camera.array.sensor_distance = 17.31e-6; }), "");
  EXPECT_EQ(error_after([](Scene& s) {
              s.camera.array.sensor_distance = 17.3e-6;
              s.camera.array.measured_from = ArrayReference::vertex;
            }),
            "");
  EXPECT_NE(error_after([](Scene& s) {
              s.camera.array.types[1].radius_front = s.camera.array.types[1].radius_back =
                  kInfinity;
            }),
            "");
  EXPECT_NE(warning_after([](Scene& s) {
              s.camera.sensor.pixel_pitch = 2e-4;
            }).find("larger than a microlens"),
            std::string::npos);
  // Without an array its values do not matter.
  EXPECT_EQ(error_after([](Scene& s) {
              s.camera.array = {};
              s.camera.focus.conjugate = "sensor";
            }),
            "");
}

TEST(Validate, ShapesOfMicrolenses) {
  // The paper's lattice is hexagonal, with a pitch and a diameter of 100 um.
  EXPECT_EQ(error_after([](Scene& s) { s.camera.array.aperture = ApertureShape::hexagonal; }), "");
  EXPECT_EQ(error_after([](Scene& s) {
              s.camera.array.aperture = ApertureShape::hexagonal;
              s.camera.array.diameter = 101e-6;
            }),
            "microlenses that are hexagonal and 101 um across overlap by 1 um in a hexagonal "
            "lattice with a pitch of 100 um; make the diameter smaller");
  // Rows are 86.6 um apart.
  EXPECT_EQ(error_after([](Scene& s) { s.camera.array.aperture = ApertureShape::square; }),
            "microlenses that are square and 100 um across overlap by 13.4 um in a hexagonal "
            "lattice with a pitch of 100 um; make the diameter smaller");
  const auto square = [](Scene& s) {
    s.camera.array.lattice = Lattice::square;
    s.camera.array.aperture = ApertureShape::square;
  };
  EXPECT_EQ(error_after([&](Scene& s) {
              square(s);
              s.camera.array.pitch_y = s.camera.array.diameter_y = 80e-6;
              s.camera.array.rotation = 0.3;
            }),
            "");
  EXPECT_EQ(error_after([&](Scene& s) {
              square(s);
              s.camera.array.pitch_y = 80e-6;
            }),
            "microlenses that are square and 100 um across overlap by 20 um in a square lattice "
            "with a pitch of 100 um and 80 um; make the diameter smaller");
  EXPECT_EQ(error_after([&](Scene& s) {
              square(s);
              s.camera.array.aperture = ApertureShape::circular;
              s.camera.array.pitch_y = 80e-6;
            }),
            "the microlenses have a diameter of 100 um at a pitch of 100 um and 80 um, so they "
            "overlap; make the diameter at most the pitch");
  EXPECT_EQ(error_after([](Scene& s) { s.camera.array.pitch_y = 80e-6; }),
            "camera.array.pitch_y is for square lattices: the rows of a hexagonal one are cos 30 "
            "of the pitch apart");
  EXPECT_EQ(error_after([](Scene& s) { s.camera.array.diameter_y = 80e-6; }),
            "camera.array.diameter_y is for square microlenses, which it makes rectangular; give "
            "aperture = \"square\"");
  EXPECT_EQ(error_after([&](Scene& s) {
              square(s);
              s.camera.array.centre_jitter = 1e-6;
            }),
            "microlenses displaced by up to 1 um would overlap: of the pitch of 100 um the "
            "diameter of 100 um leaves 0 m to each; make centre_jitter or diameter smaller");
  // At its corners a square is 1.41 times as wide.
  EXPECT_EQ(error_after([&](Scene& s) {
              square(s);
              s.camera.array.types[0].radius_front = 60e-6;
            }),
            "microlens type 0 has a radius_front of 60 um, too small for the diameter of 141.4 um "
            "across its corners");
}

TEST(Validate, PupilFilters) {
  const auto error = [](const std::vector<PupilFilterSpec>& filters) {
    return error_after([&](Scene& s) {
      s.camera.pupil_filters = filters;
      s.channels = {{"red", ChannelKind::band, 650e-9, 10e-9}};
    });
  };
  PupilFilterSpec a{"a"}, b{"b"};
  a.extent = b.extent = 3;
  b.angle = 3;
  EXPECT_EQ(error({a, b}), "");
  b.name = "a";
  EXPECT_EQ(error({a, b}), "pupil filters 0 and 1 are both named \"a\"; names must differ");
  a.name = b.name = "";
  EXPECT_EQ(error({a, b}), "");
  a.name = "a", b.name = "b";
  b.angle = 2.9;
  EXPECT_EQ(error({a, b}),
            "pupil filter \"a\" and pupil filter \"b\" overlap; a part of the stop can have one "
            "filter only");
  PupilFilterSpec outside{"far", PupilPartShape::polygon};
  outside.corners = {{1.1, 0}, {2, 0}, {2, 1}};
  EXPECT_EQ(error({outside}),
            "pupil filter \"far\" lies outside of the stop, whose radius is 1, and covers "
            "nothing");
  outside.corners.pop_back();
  EXPECT_EQ(error({outside}), "pupil filter \"far\" is a polygon and needs three corners or more");
  outside.corners = {{0, 0}, {1, 0}, {0.1, 0.1}, {0, 1}};
  EXPECT_EQ(error({outside}).substr(0, 36), "pupil filter \"far\" is not convex, or");
  a.inner = 0.5;
  a.outer = 0.4;
  EXPECT_EQ(error({a}),
            "pupil filter \"a\" reaches from 0.5 to 0.4 radii of the stop; its outer radius must "
            "be larger");
  a.outer = 1;
  a.transmission = "600 nm 1.1, 700 nm 1";
  EXPECT_EQ(error({a}),
            "camera.pupil_filters[0].transmission: a filter lets at most everything through, 1");
  PupilFilterSpec whole{"whole"};
  whole.transmission = "400 nm 1, 500 nm 1";
  // An opaque mask is one, too.
  for (const char* dark : {"400 nm 1, 500 nm 1", "400 nm 0, 800 nm 0"}) {
    whole.transmission = dark;
    EXPECT_EQ(error({whole}), "");
    EXPECT_EQ(warning_after([&](Scene& s) {
                s.camera.pupil_filters = {whole};
                s.channels = {{"red", ChannelKind::band, 650e-9, 10e-9}};
              }),
              "no pupil filter transmits light of channel \"red\", so its picture is black");
  }
  whole.transmission = "400 nm 0";
  EXPECT_EQ(error({whole}),
            "camera.pupil_filters[0].transmission: a curve needs at least two points");
}

TEST(Validate, SensorAndFocus) {
  EXPECT_EQ(error_after([](Scene& s) { s.camera.sensor.columns = 0; }),
            "camera.sensor.columns is missing; 1 to 65536 is allowed");
  EXPECT_EQ(error_after([](Scene& s) {
              s.camera.sensor = {65536, 65536, 1e-6};
            }),
            "the sensor has 65536 x 65536 pixels; at most 1000 million are possible");
  EXPECT_EQ(error_after([](Scene& s) { s.camera.focus.conjugate = "type4"; }),
            "camera.focus.conjugate is \"type4\", but with this camera it can be array, type1, "
            "type2, type3");
  EXPECT_EQ(error_after([](Scene& s) { s.camera.array.present = false; }),
            "camera.focus.conjugate is \"type2\", but with this camera it can be sensor");
  EXPECT_NE(error_after([](Scene& s) { s.camera.focus.object_distance = 0; }).find("is missing"),
            std::string::npos);
  EXPECT_NE(error_after([](Scene& s) {
              s.camera.focus.mode = FocusMode::distance;
            }).find("lens_distance is missing"),
            std::string::npos);
  // The front focal point is 295.9014 mm in front of the vertex.
  EXPECT_EQ(error_after([](Scene& s) { s.camera.focus.object_distance = 0.2959; }),
            "the object plane at 295.9 mm lies inside the front focal point at 295.9 mm, so its "
            "image is virtual and "
            "cannot be in focus; move it farther away");
  // f^2 / (o - f_front) behind the rear focal point: 304.0986^2 mm / 8.573 um = 10.79 km.
  EXPECT_EQ(warning_after([](Scene& s) { s.camera.focus.object_distance = 0.29591; }),
            "the image lies 10790 m behind the lens: the object is close to its front focal plane");
  EXPECT_EQ(warning_after([](Scene& s) { s.camera.focus.object_distance = kInfinity; }),
            "0 warnings");
}

TEST(Validate, FlamesAndWhereTheyAre) {
  EXPECT_EQ(warning_after([](Scene& s) { s.flames.clear(); }),
            "the scene has no flame, so its picture is black");
  EXPECT_NE(error_after([](Scene& s) { s.flames[0].layers.clear(); }).find("has no layers"),
            std::string::npos);
  EXPECT_NE(error_after([](Scene& s) { s.flames[0].kind = FlameKind::vdb; }).find("needs a file"),
            std::string::npos);
  EXPECT_EQ(error_after([](Scene& s) { s.flames[0].temperature.unit = "1/m"; }),
            "flames[0].temperature.unit is \"1/m\"; it must be one of K, degC");
  EXPECT_EQ(error_after([](Scene& s) { s.flames[0].layers[1].temperature = 0; }),
            "flames[0].layers[1].temperature is missing; above 0 K, at most 100000 K is allowed");
  EXPECT_EQ(error_after([](Scene& s) { s.flames[0].position.x = 0.005; }),
            "flame \"paper-layered\" reaches into the camera: it extends from -5 mm to 15 mm in "
            "front of the front "
            "vertex; move it away");
  EXPECT_EQ(error_after([](Scene& s) { s.flames[0].position.x = -1; }),
            "flame \"paper-layered\" lies behind the front of the camera; move it to where the "
            "camera looks");
  // Lying on its side it reaches 59 mm along the axis: rotated by +90 degrees about y, z becomes x.
  EXPECT_EQ(error_after([](Scene& s) {
              s.flames[0].rotation.y = std::acos(-1.0) / 2;
              s.flames[0].position = {-0.010, 0, 0};
            }),
            "flame \"paper-layered\" reaches into the camera: it extends from -11 mm to 49 mm in "
            "front of the front "
            "vertex; move it away");
  // About x by 90 degrees z becomes -y, then about z by 90 degrees x: the same extent. (The inverse
  // rotation would put the flame's y there.)
  EXPECT_NE(error_after([](Scene& s) {
              s.flames[0].rotation = {std::acos(-1.0) / 2, 0, std::acos(-1.0) / 2};
              s.flames[0].position = {-0.010, 0, 0};
            }).find("extends from -11 mm to 49 mm"),
            std::string::npos);
  EXPECT_EQ(warning_after([](Scene& s) { s.flames[0].position.x = 0.3; }),
            "flame \"paper-layered\" begins 290 mm in front of the front vertex, inside the front "
            "focal point at 295.9 "
            "mm: the image of that part is virtual and far out of focus");
  EXPECT_EQ(warning_after([](Scene& s) { s.flames[0].position.x = 0.306; }), "0 warnings");
  // Twice as large it reaches twice as far from its own origin.
  EXPECT_NE(error_after([](Scene& s) {
              s.flames[0].scale = 2;
              s.flames[0].position.x = 0.005;
            }).find("extends from -15 mm to 25 mm"),
            std::string::npos);
  EXPECT_EQ(error_after([](Scene& s) { s.flames[0].scale = -1; }),
            "flames[0].scale: -1 is not possible here; above 0, at most 1e9 is allowed");
  // The camera moved and turned with the flame sees the same.
  EXPECT_NE(error_after([](Scene& s) {
              s.camera.position = {5, 0, 0};
              s.camera.look_direction = {-2, 0, 0};
              s.flames[0].position.x = 4.995;
            }).find("extends from -5 mm to 15 mm"),
            std::string::npos);
}

TEST(Validate, FlameBoxOfAFile) {
  const Scene scene = sound();
  const auto check = [&](Vec3 lower, Vec3 upper) {
    return check_flame_box(scene.camera, "c", {lower, upper}, "flames[0]");
  };
  EXPECT_TRUE(check({0.9, -0.1, -0.1}, {1.1, 0.1, 0.1}).empty());
  EXPECT_TRUE(check({1, 1, 1}, {-1, -1, -1}).empty());  // an empty box
  ASSERT_EQ(check({-0.1, -0.1, -0.1}, {1.1, 0.1, 0.1}).size(), 1u);
  EXPECT_TRUE(check({-0.1, -0.1, -0.1}, {1.1, 0.1, 0.1})[0].is_error);
  ASSERT_EQ(check({0.2, -0.1, -0.1}, {1.1, 0.1, 0.1}).size(), 1u);
  EXPECT_FALSE(check({0.2, -0.1, -0.1}, {1.1, 0.1, 0.1})[0].is_error);
}

TEST(Validate, Channels) {
  const auto band = [](const char* name, double wavelength, double width) {
    return [=](Scene& s) { s.channels.push_back({name, ChannelKind::band, wavelength, width}); };
  };
  EXPECT_EQ(error_after(band("red", 650e-9, 10e-9)), "");
  EXPECT_EQ(error_after(band("total", 650e-9, 10e-9)),
            "channels 0 and 1 are both named \"total\"; names must differ");
  EXPECT_EQ(error_after(band("a.b", 650e-9, 10e-9)),
            "the channel name \"a.b\" is not made of letters, digits, _ and -");
  const std::string longest(100, 'r'), longer(101, 'r');
  EXPECT_EQ(error_after(band(longest.c_str(), 650e-9, 10e-9)), "");
  EXPECT_EQ(error_after(band(longer.c_str(), 650e-9, 10e-9)),
            "the channel name \"" + longer.substr(0, 60) +
                "...\" has 101 characters; at most 100 are allowed");
  EXPECT_EQ(error_after(band("red", 0, 10e-9)), "channel \"red\" is a band and needs a wavelength");
  EXPECT_EQ(error_after(band("red", 650e-9, 0)), "channel \"red\" is a band and needs a width");
  EXPECT_NE(error_after(band("red", 650e-9, 1300e-9)), "");
  EXPECT_NE(error_after([](Scene& s) { s.channels.clear(); }), "");
  EXPECT_NE(warning_after([](Scene& s) { s.channels[0].width = 1e-8; }).find("not used"),
            std::string::npos);
}

TEST(Validate, ErrorsAreGivenAtTheirPlaceInTheFile) {
  const SceneDocument document = parse_scene(
      std::string(kScene) + "[camera.array]\n  pitch = \"90 um\"\n[camera.sensor]\nrows = 9\n",
      "s.toml");
  // Pitch and diameter contradict each other; the one that the file gives is shown, not the
  // preset's.
  EXPECT_EQ(message_of([&] { validate(document); }).substr(0, 33),
            "s.toml:7:11: the microlenses have");
  const SceneDocument preset =
      parse_scene("[camera]\npreset = \"r12\"\narray.types = []\n", "s.toml");
  EXPECT_EQ(message_of([&] { validate(preset); }).substr(0, 14), "s.toml:3:15: t");
  const SceneDocument renamed = parse_scene(
      "[camera]\npreset = \"r12\"\narray.types = [{name = \"a\", radius_back = \"1 mm\"}]\n",
      "s.toml");
  EXPECT_EQ(message_of([&] { validate(renamed); }).substr(0, 36),
            "s.toml:3:15: camera.focus.conjugate ");
  const SceneDocument focus =
      parse_scene(std::string(kScene) + "[camera.focus]\nconjugate = \"typ2\"\n", "s.toml");
  EXPECT_EQ(message_of([&] { validate(focus); }).substr(0, 14), "s.toml:7:13: c");
  // A key that stands nowhere in the file is at least said to be missing there.
  const SceneDocument empty = parse_scene("", "empty.toml");
  EXPECT_EQ(message_of([&] { validate(empty); }),
            "empty.toml: camera.sensor.columns is missing; 1 to 65536 is allowed; the "
            "easiest start is a preset: [camera] preset = \"paper-plenoptic2\"");
  const SceneDocument near =
      parse_scene(std::string(kScene) + "[camera.focus]\nobject_distance = \"10 cm\"\n", "s.toml");
  EXPECT_EQ(message_of([&] { validate(near); }).substr(0, 14), "s.toml:7:19: t");
}

TEST(Validate, IdealLensesThatNoGlassCouldBe) {
  const auto ideal = [](Scene& s, double focal_length) {
    s.camera.array.model = LensModel::ideal;
    for (MicrolensSpec& type : s.camera.array.types)
      type = {type.name, kInfinity, kInfinity, 1.5, 0.2e-3};
    s.camera.array.types[1].focal_length = focal_length;
  };
  const auto error = [&](double f) { return error_after([&](Scene& s) { ideal(s, f); }); };
  EXPECT_EQ(error(1e-53),
            "camera.array.types[1].focal_length is 1e-44 nm, too short for glass with the "
            "diameter 100 um; it must be at least 6.25 um");
  // Two faces of radius D / 2 and index 5, the lensmaker's equation: f = D / 16.
  EXPECT_EQ(error(6.26e-6), "");
  EXPECT_EQ(error(-6.26e-6), "");
  EXPECT_NE(error(-6.24e-6), "");
  // Radii beside it do not hide it: the focal length is what counts.
  EXPECT_NE(error_after([](Scene& s) {
              s.camera.array.model = LensModel::ideal;
              s.camera.array.types[1].focal_length = 1e-53;
            }),
            "");
  EXPECT_NE(error_after([](Scene& s) {
              s.camera.lens = {};
              s.camera.lens.model = LensModel::ideal;
              s.camera.lens.focal_length = 1e-50;
              s.camera.lens.diameter = 0.1;
            }).find("camera.lens.focal_length is"),
            std::string::npos);
}

TEST(Validate, MicroImagesThatLieOverEachOtherByTheHundreds) {
  // f/2.958 with its image at 0.437 m: B of 50 mm makes micro-images 115 pitches of 0.1 mm wide.
  EXPECT_NE(error_after([](Scene& s) {
              s.camera.array.sensor_distance = 50e-3;
            }).find("make camera.array.sensor_distance or the stop smaller"),
            std::string::npos);
  EXPECT_EQ(error_after([](Scene& s) { s.camera.array.sensor_distance = 30e-3; }), "");
}

}  // namespace
}  // namespace plenoflame::validate_test
