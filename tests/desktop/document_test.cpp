// The document: edits, undo, files, recovery. References: the scene reader, and the command.
#include "model/document.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "model/parameter_model.h"
#include "model/recovery.h"
#include "plenoflame/base/error.h"
#include "plenoflame/image/atomic_file.h"
#include "plenoflame/scene/scene_schema.h"
#include "scenes.h"
#include "support/approx.h"
#include "support/temporary_folder.h"

namespace plenoflame::desktop::test {
namespace {

using plenoflame::test::relative;
using plenoflame::test::TemporaryFolder;

/// The text that the command prints on standard error about a file, and its status.
std::string run_command(const std::string& arguments, int& status) {
  FILE* const pipe = popen(("'" PLENOFLAME_COMMAND "' " + arguments + " 2>&1").c_str(), "r");
  std::string text;
  std::array<char, 256> part{};
  while (std::fgets(part.data(), part.size(), pipe)) text += part.data();
  status = pclose(pipe);
  return text;
}

class DocumentTest : public ::testing::Test {
 protected:
  void SetUp() override { document_.open_text(small_scene_text(), "small.toml"); }
  Document document_;
};

TEST_F(DocumentTest, UndoneEditsLeaveNothingBehind) {
  const Scene first = parse_scene(small_scene_text(), "small.toml").scene;
  ASSERT_EQ(document_.scene(), first);
  document_.set_value("camera.focus.object_distance", "1.25 m");
  document_.insert_item("flames", 1);
  document_.apply_preset(PresetKind::lens, "objective-50mm");
  const Scene last = document_.scene();
  EXPECT_EQ(last.camera.focus.object_distance, 1.25);
  EXPECT_EQ(last.flames.size(), 2U);
  EXPECT_NE(last.camera.lens, first.camera.lens);
  EXPECT_TRUE(document_.is_modified());
  for (int i = 0; i < 3; ++i) document_.undo();
  EXPECT_EQ(document_.scene(), first);
  EXPECT_FALSE(document_.can_undo());
  EXPECT_FALSE(document_.is_modified());
  for (int i = 0; i < 3; ++i) document_.redo();
  EXPECT_EQ(document_.scene(), last);
  EXPECT_FALSE(document_.can_redo());
  document_.undo();
  document_.set_value("render.samples", "16");  // what was undone cannot come back
  EXPECT_FALSE(document_.can_redo());
}

TEST_F(DocumentTest, ValuesOfASliderAreOneStep) {
  for (int i = 1; i <= 50; ++i)
    document_.set_value("camera.focus.object_distance", std::to_string(1000 + i) + " mm");
  document_.undo();
  EXPECT_FALSE(document_.can_undo());
  EXPECT_EQ(document_.scene(), parse_scene(small_scene_text(), "small.toml").scene);
}

TEST_F(DocumentTest, WhatWasSavedInTheMiddleOfADragCanBeReachedAgain) {
  const TemporaryFolder folder;
  document_.set_value("camera.focus.object_distance", "1001 mm");
  document_.save(folder.file("scene.toml"));
  document_.set_value("camera.focus.object_distance", "1002 mm");
  EXPECT_TRUE(document_.is_modified());
  document_.undo();
  EXPECT_FALSE(document_.is_modified());
  EXPECT_EQ(document_.scene().camera.focus.object_distance, 1.001);
}

TEST_F(DocumentTest, EditAfterAnUndoIsAStepOfItsOwn) {
  document_.set_value("camera.focus.object_distance", "1001 mm");
  document_.set_value("render.samples", "8");
  document_.undo();
  document_.set_value("camera.focus.object_distance", "1002 mm");
  document_.undo();
  EXPECT_EQ(document_.scene().camera.focus.object_distance, 1.001);
  EXPECT_TRUE(document_.can_undo());
}

TEST_F(DocumentTest, LookOfTheFlameIsUndoneButNotSaved) {
  int looks = 0, scenes = 0;
  QObject::connect(&document_, &Document::look_changed, &document_, [&] { ++looks; });
  QObject::connect(&document_, &Document::scene_changed, &document_, [&] { ++scenes; });
  const FlameLook first = document_.look();
  FlameLook look = first;
  // A drag is one step, the next drag another.
  for (int i = 0; i < 10; ++i) {
    look.points[0].opacity = 0.09 * i;
    document_.set_look(look, "opacity", "stroke 1");
  }
  const FlameLook dragged = look;
  look.points[1].opacity = 0.5;
  document_.set_look(look, "opacity", "stroke 2");
  EXPECT_FALSE(document_.is_modified());
  document_.set_value("render.samples", "8");
  EXPECT_TRUE(document_.is_modified());
  EXPECT_EQ(document_.look(), look);
  EXPECT_EQ(looks, 11);
  EXPECT_EQ(scenes, 1);
  document_.undo();  // the samples
  EXPECT_EQ(document_.look(), look);
  EXPECT_EQ(looks, 11);
  EXPECT_FALSE(document_.is_modified());
  document_.undo();
  EXPECT_EQ(document_.look(), dragged);
  EXPECT_EQ(document_.undo_text(), "opacity");
  document_.undo();
  EXPECT_EQ(document_.look(), first);
  EXPECT_FALSE(document_.can_undo());
  document_.redo();
  document_.redo();
  EXPECT_EQ(document_.look(), look);
  // Another scene keeps the look; what it had begun with is no step.
  document_.open_text(small_scene_text(), "again.toml");
  EXPECT_EQ(document_.look(), look);
  EXPECT_FALSE(document_.can_undo());
}

TEST_F(DocumentTest, LookAfterAnUndoIsAStepOfItsOwn) {
  FlameLook look = document_.look();
  look.density = 2;
  document_.set_look(look, "density", "stroke 1");
  const FlameLook first = look;
  look.density = 3;
  document_.set_look(look, "density", "stroke 2");
  document_.undo();
  look.density = 4;
  document_.set_look(look, "density", "stroke 1");  // the word of the step that is left
  document_.undo();
  EXPECT_EQ(document_.look(), first);
}

TEST_F(DocumentTest, PresetsStayWhereTheirPredecessorsStood) {
  document_.set_value("camera.position", "1 mm, 2 mm, 3 mm");
  document_.set_value("camera.look_direction", "1, 0.25, 0");
  document_.set_value("camera.up", "0, 0.5, 1");
  document_.set_value("flames[0].position", "1.1 m, 0 m, 0.1 m");
  document_.set_value("flames[0].rotation", "0.1 rad, 0.2 rad, 0.3 rad");
  document_.set_value("flames[0].scale", "1.5");
  const Scene before = document_.scene();
  document_.apply_preset(PresetKind::camera, "raytrix-r29");
  EXPECT_NE(document_.scene().camera, before.camera);
  EXPECT_EQ(document_.scene().camera.position, before.camera.position);
  EXPECT_EQ(document_.scene().camera.look_direction, before.camera.look_direction);
  EXPECT_EQ(document_.scene().camera.up, before.camera.up);
  const std::string other = preset_names(PresetKind::flame).back();
  document_.apply_preset(PresetKind::flame, other, 0);
  ASSERT_EQ(document_.scene().flames.size(), 1U);
  EXPECT_NE(document_.scene().flames[0], before.flames[0]);
  EXPECT_EQ(document_.scene().flames[0].position, before.flames[0].position);
  EXPECT_EQ(document_.scene().flames[0].rotation, before.flames[0].rotation);
  // One more stands where the first does, not where the camera is.
  document_.apply_preset(PresetKind::flame, other, 1);
  ASSERT_EQ(document_.scene().flames.size(), 2U);
  EXPECT_EQ(document_.scene().flames[1].position, before.flames[0].position);
}

TEST_F(DocumentTest, OneOfSeveralCamerasIsChosen) {
  document_.insert_item("cameras", 0);  // the one camera becomes the first of two
  ASSERT_EQ(document_.scene().cameras.size(), 2U);
  EXPECT_EQ(document_.camera_name(), "camera1");
  document_.set_value("cameras[1].position", "1 mm, 2 mm, 3 mm");
  EXPECT_NE(document_.camera().position.x, 1e-3);
  int calls = 0;
  bool optics = false;
  QObject::connect(&document_, &Document::scene_changed, &document_,
                   [&](const SceneChanges& changes) { ++calls, optics = changes.camera; });
  const Scene before = document_.scene();
  document_.choose_camera("camera2");
  document_.choose_camera("camera2");
  EXPECT_EQ(calls, 1);
  EXPECT_TRUE(optics);
  EXPECT_EQ(document_.scene(), before);
  EXPECT_EQ(document_.camera().position.x, 1e-3);
  EXPECT_EQ(document_.scene_of_camera().scene.camera, document_.camera());
  EXPECT_THROW(document_.choose_camera("camera3"), InputError);
  document_.apply_preset(PresetKind::camera, "raytrix-r29", 1);
  EXPECT_EQ(document_.camera().name, "camera2");
  EXPECT_EQ(document_.camera().position.x, 1e-3);
  EXPECT_EQ(document_.scene().cameras[0], before.cameras[0]);
  document_.erase_item("cameras", 1);
  EXPECT_EQ(document_.camera_name(), "camera1");
  while (document_.can_undo()) document_.undo();
  EXPECT_EQ(document_.camera_name(), "");
  EXPECT_EQ(document_.scene(), parse_scene(small_scene_text(), "small.toml").scene);
}

TEST_F(DocumentTest, EveryOtherSelectionIsTold) {
  int calls = 0;
  QObject::connect(&document_, &Document::selection_changed, &document_, [&] { ++calls; });
  document_.select(Selection::of_pixel(3, 4));
  document_.select(Selection::of_pixel(3, 4));
  EXPECT_EQ(calls, 1);
  document_.select(Selection::of_pixel(3, 5));
  document_.select(Selection::of_pixel(4, 5));
  document_.select(Selection::of_microlens({3, 4}));
  document_.select(Selection::of_microlens({3, 5}));
  document_.select(Selection::of_microlens({4, 5}));
  document_.select(Selection::of_point({1, 0, 0}));
  document_.select(Selection::of_point({1, 0, 1}));
  document_.select({});
  EXPECT_EQ(calls, 9);
}

TEST(FlameLook, OpacityRunsStraightBetweenPoints) {
  const std::vector<OpacityPoint> points{{0, 0.2}, {0.5, 1}, {1, 0.4}};
  EXPECT_EQ(opacity_at(points, -1), 0.2);
  EXPECT_EQ(opacity_at(points, 0), 0.2);
  EXPECT_TRUE(relative(opacity_at(points, 0.25), 0.6, 1e-12));
  EXPECT_EQ(opacity_at(points, 0.5), 1.0);
  EXPECT_TRUE(relative(opacity_at(points, 0.75), 0.7, 1e-12));
  EXPECT_EQ(opacity_at(points, 2), 0.4);
}

TEST(FlameLook, PointsStayInOrderAndEndsStay) {
  std::vector<OpacityPoint> points{{0, 1}, {1, 1}};
  EXPECT_EQ(add_point(points, {0.6, 0.3}), 1U);
  EXPECT_EQ(add_point(points, {0.2, 0.9}), 1U);
  ASSERT_EQ(points.size(), 4U);
  move_point(points, 1, {0.9, 2});  // beyond its neighbour, and more than opaque
  EXPECT_LT(points[1].place, points[2].place);
  EXPECT_GT(points[1].place, 0.59);
  EXPECT_EQ(points[1].opacity, 1.0);
  move_point(points, 0, {0.3, 0.5});
  EXPECT_EQ(points[0], (OpacityPoint{0, 0.5}));
  move_point(points, 3, {0.3, -1});
  EXPECT_EQ(points[3], (OpacityPoint{1, 0}));
  EXPECT_FALSE(remove_point(points, 0));
  EXPECT_FALSE(remove_point(points, 3));
  EXPECT_TRUE(remove_point(points, 1));
  ASSERT_EQ(points.size(), 3U);
  EXPECT_EQ(points[1].opacity, 0.3);
}

TEST(FlameLook, TextReadsBackAndNonsenseIsRefused) {
  FlameLook look;
  look.map = ColourMap::cividis;
  look.automatic = false;
  look.cold = 900;
  look.hot = 1900.5;
  look.density = 0.25;
  look.points = {{0, 0}, {0.375, 0.1}, {1, 0.9}};
  const auto read = look_from_text(look_to_text(look));
  ASSERT_TRUE(read.has_value());
  EXPECT_EQ(*read, look);
  for (
      const char* text :
      {"", "{}", "not json", R"({"colours":"grey","density":1,"points":[[0,1],[1,1]]})",
       R"({"colours":"inferno","density":0,"points":[[0,1],[1,1]]})",
       R"({"colours":"inferno","density":1,"points":[[0,1]]})",
       R"({"colours":"inferno","density":1,"points":[[0,1],[0.5,2],[1,1]]})",
       R"({"colours":"inferno","density":1,"points":[[0,1],[0.7,1],[0.5,1],[1,1]]})",
       R"({"colours":"inferno","density":1,"automatic":false,"cold":5,"hot":5,"points":[[0,1],[1,1]]})"})
    EXPECT_FALSE(look_from_text(text).has_value()) << text;
}

TEST_F(DocumentTest, RefusedValueChangesNothingAndSaysWhatTheCommandSays) {
  const Scene before = document_.scene();
  struct Wrong {
    const char *path, *table, *key, *text;
  };
  const std::array<Wrong, 4> wrong{
      {{"camera.sensor.pixel_pitch", "camera.sensor", "pixel_pitch", "-3 um"},
       {"camera.sensor.pixel_pitch", "camera.sensor", "pixel_pitch", "3"},
       {"camera.array.pitch", "camera.array", "pitch", "3 kg"},
       {"camera.array.lattice", "camera.array", "lattice", "triangular"}}};
  const TemporaryFolder folder;
  for (const Wrong& w : wrong) {
    std::string said;
    try {
      document_.set_value(w.path, w.text);
    } catch (const InputError& error) {
      said = error.what();
    }
    ASSERT_FALSE(said.empty()) << w.text;
    EXPECT_EQ(document_.scene(), before);
    EXPECT_FALSE(document_.can_undo());
    write_file(folder.file("wrong.toml"), "[camera]\npreset = \"paper-previous-60x60\"\n[" +
                                              std::string(w.table) + "]\n" + w.key + " = \"" +
                                              w.text + "\"\n");
    int status = 0;
    const std::string command = run_command("info " + folder.file("wrong.toml"), status);
    EXPECT_NE(status, 0);
    // Faults are named in the same words; the command adds their place in the file.
    const std::size_t key = said.find(w.key);
    const std::string words = said.substr(key == std::string::npos ? 0 : key);
    EXPECT_NE(command.find(words), std::string::npos) << command << "\nwithout: " << words;
  }
}

TEST_F(DocumentTest, SavedSceneReadsBackEqualAndNamesTheSameFiles) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder.file("flames"));
  std::filesystem::create_directory(folder.file("scenes"));
  write_file(folder.file("flames/a.vdb"), "not opened here");
  write_file(folder.file("first.toml"),
             small_scene_text() +
                 "\n[[flames]]\nkind = \"vdb\"\nfile = \"flames/a.vdb\"\n"
                 "position = [\"1 m\", \"0 m\", \"0 m\"]\n");
  document_.open(folder.file("first.toml"));
  document_.set_value("camera.focus.object_distance", "1.1 m");
  EXPECT_TRUE(document_.is_modified());
  document_.save(folder.file("scenes/second.toml"));
  EXPECT_FALSE(document_.is_modified());
  const Scene read = read_scene_file(folder.file("scenes/second.toml")).scene;
  EXPECT_EQ(read, document_.scene());
  ASSERT_EQ(read.flames.size(), 2U);
  EXPECT_EQ(read.flames[1].file, "../flames/a.vdb");
  document_.undo();
  EXPECT_TRUE(document_.is_modified());
}

TEST_F(DocumentTest, FileThatCannotBeOpenedLeavesTheDocument) {
  const Scene before = document_.scene();
  const TemporaryFolder folder;
  write_file(folder.file("bad.toml"), "[camera]\npreset = \"no-such-camera\"\n");
  EXPECT_THROW(document_.open(folder.file("bad.toml")), InputError);
  EXPECT_THROW(document_.open(folder.file("missing.toml")), FileError);
  EXPECT_THROW(document_.open(folder.file("missing.vdb")), FileError);
  EXPECT_THROW(document_.open(folder.file("picture.gif")), UsageError);
  EXPECT_THROW(document_.save(folder.file("no/such/folder/x.toml")), FileError);
  EXPECT_EQ(document_.scene(), before);
  EXPECT_EQ(document_.file(), "");
}

TEST_F(DocumentTest, ChangesAreSortedByWhatTheyTouch) {
  SceneChanges seen;
  int calls = 0;
  QObject::connect(&document_, &Document::scene_changed, &document_,
                   [&](const SceneChanges& changes) {
                     seen = changes;
                     ++calls;
                   });
  document_.set_value("develop.bits", "8");
  EXPECT_TRUE(seen.develop);
  EXPECT_FALSE(seen.image());
  document_.set_value("flames[0].name", "another");
  EXPECT_TRUE(seen.names);
  EXPECT_FALSE(seen.image());
  document_.set_value("flames[0].position", "1.2 m, 0 m, 0 m");
  EXPECT_TRUE(seen.flames);
  EXPECT_FALSE(seen.camera);
  document_.set_value("camera.array.rotation", "1 deg");
  EXPECT_TRUE(seen.camera);
  EXPECT_FALSE(seen.flames);
  document_.set_value("render.samples", "8");
  EXPECT_TRUE(seen.samples);
  EXPECT_FALSE(seen.compiled());
  document_.set_value("render.samples", "8");  // as it is
  EXPECT_EQ(calls, 5);
}

TEST_F(DocumentTest, ThousandEditsTakeNoMoreMemory) {
  const auto resident = [] {
    std::ifstream file("/proc/self/statm");
    long total = 0, pages = 0;
    file >> total >> pages;
    return static_cast<double>(pages) * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1e6;
  };
  ParameterModel model(document_);
  const auto edit = [&](int i) {
    document_.set_value(
        i % 2 == 0 ? "camera.focus.object_distance" : "flames[0].scale",
        i % 2 == 0 ? std::to_string(1000 + i % 97) + " mm" : std::to_string(1 + 0.001 * (i % 89)));
  };
  for (int i = 0; i < 600; ++i) edit(i);  // the history is full
  const double before = resident();
  for (int i = 600; i < 1600; ++i) edit(i);
  // A state of the history has about 20 kB: a leak of one per edit would be 20 MB.
  EXPECT_LT(resident() - before, 4);
}

TEST_F(DocumentTest, RecoveryFindsWhatADeadProgramLeft) {
  const TemporaryFolder folder;
  // With a file beside it, which the copy must name from where it lies itself.
  write_file(folder.file("mine.toml"), small_scene_text() +
                                           "\n[[flames]]\nkind = \"vdb\"\nfile = \"beside.vdb\"\n"
                                           "position = [\"1 m\", \"0 m\", \"0 m\"]\n");
  document_.open(folder.file("mine.toml"));
  document_.set_value("camera.focus.object_distance", "1.5 m");
  const Scene edited = document_.scene();
  const pid_t child = fork();
  if (child == 0) {
    auto* const recovery = new Recovery(folder.file("recovery"));
    recovery->keep(document_);
    _exit(0);  // as if it had crashed: nothing is taken away
  }
  int status = 0;
  waitpid(child, &status, 0);
  Recovery recovery(folder.file("recovery"));
  EXPECT_TRUE(recovery.ended_badly());
  EXPECT_FALSE(recovery.ended_badly());  // said once
  const auto left = recovery.left_behind();
  ASSERT_EQ(left.size(), 1U);
  EXPECT_EQ(left[0].file, folder.file("mine.toml"));
  Document other;
  other.recover(left[0]);
  EXPECT_EQ(other.scene(), edited);
  EXPECT_EQ(other.file(), folder.file("mine.toml"));
  EXPECT_TRUE(other.is_modified());
  Recovery::discard(left[0]);
  EXPECT_TRUE(recovery.left_behind().empty());
}

TEST_F(DocumentTest, CopyOfAProgramThatRunsIsLeftAlone) {
  const TemporaryFolder folder;
  document_.set_value("camera.focus.object_distance", "1.5 m");
  std::array<int, 2> ready{};
  ASSERT_EQ(pipe(ready.data()), 0);
  const pid_t child = fork();
  if (child == 0) {
    auto* const recovery = new Recovery(folder.file("recovery"));
    recovery->keep(document_);
    if (write(ready[1], "x", 1) != 1) _exit(1);
    for (;;) pause();  // until it is killed
  }
  char word = 0;
  ASSERT_EQ(read(ready[0], &word, 1), 1);
  Recovery recovery(folder.file("recovery"));
  const bool told = recovery.ended_badly();
  const auto running = recovery.left_behind();
  kill(child, SIGKILL);
  int status = 0;
  waitpid(child, &status, 0);
  close(ready[0]);
  close(ready[1]);
  EXPECT_FALSE(told);
  EXPECT_TRUE(running.empty());
  EXPECT_TRUE(recovery.ended_badly());
  EXPECT_EQ(recovery.left_behind().size(), 1U);
}

TEST_F(DocumentTest, OwnRecoveryGoesWhenNothingIsUnsaved) {
  const TemporaryFolder folder;
  std::string copy;
  {
    Recovery recovery(folder.file("recovery"));
    copy = recovery.path();
    recovery.keep(document_);
    EXPECT_FALSE(std::filesystem::exists(copy));
    document_.set_value("render.samples", "8");
    recovery.keep(document_);
    EXPECT_TRUE(std::filesystem::exists(copy));
    EXPECT_TRUE(recovery.left_behind().empty());  // this program is still there
    document_.undo();  // as it was saved: nothing to recover, should it crash now
    recovery.keep(document_);
    EXPECT_FALSE(std::filesystem::exists(copy));
    document_.redo();
    recovery.keep(document_);
    Recovery another(folder.file("recovery"));
    EXPECT_FALSE(another.ended_badly());
  }
  EXPECT_FALSE(std::filesystem::exists(copy));
}

TEST_F(DocumentTest, TreeHasEveryValueOfTheScene) {
  ParameterModel model(document_);
  std::size_t found = 0;
  for (const std::string& path : scene_paths(document_.scene())) {
    const QModelIndex index = model.find(path, ParameterModel::kValue);
    ASSERT_TRUE(index.isValid()) << path;
    EXPECT_EQ(index.data().toString().toStdString(), get_text(document_.scene(), path));
    EXPECT_FALSE(index.data(Qt::ToolTipRole).toString().isEmpty()) << path;
    ++found;
  }
  EXPECT_GT(found, 50U);
}

TEST_F(DocumentTest, TreeKeepsARefusedValueWithItsMessage) {
  ParameterModel model(document_);
  const std::string path = "camera.sensor.pixel_pitch";
  const QModelIndex index = model.find(path, ParameterModel::kValue);
  EXPECT_FALSE(model.setData(index, "-1 um"));
  EXPECT_EQ(index.data().toString(), "-1 um");
  EXPECT_TRUE(index.data(ParameterModel::kIsErrorRole).toBool());
  EXPECT_FALSE(index.data(ParameterModel::kMessageRole).toString().isEmpty());
  EXPECT_EQ(document_.scene().camera.sensor.pixel_pitch, 100e-6);
  EXPECT_TRUE(model.setData(index, "90 um"));
  EXPECT_TRUE(model.find(path, ParameterModel::kValue)
                  .data(ParameterModel::kMessageRole)
                  .toString()
                  .isEmpty());
  EXPECT_EQ(document_.scene().camera.sensor.pixel_pitch, 90e-6);
}

TEST_F(DocumentTest, TreeShowsIssuesAtTheirValue) {
  ParameterModel model(document_);
  document_.set_value("flames[0].position", "-1 m, 0 m, 0 m");  // behind the camera
  ASSERT_FALSE(document_.is_valid());
  const SceneIssue issue = document_.issues().front();
  const QModelIndex index = model.find(issue.key, ParameterModel::kValue);
  ASSERT_TRUE(index.isValid()) << issue.key;
  EXPECT_EQ(index.data(ParameterModel::kMessageRole).toString().toStdString(), issue.message);
}

}  // namespace
}  // namespace plenoflame::desktop::test
