#include <QAction>
#include <QBuffer>
#include <QDir>
#include <QFileInfo>
#include <QFormLayout>
#include <QInputDialog>
#include <QMenu>
#include <QMessageBox>
#include <QStandardPaths>
#include <QStatusBar>
#include <filesystem>
#include <memory>

#include "image_files.h"
#include "model/example_flames.h"
#include "plenoflame/base/error.h"
#include "plenoflame/image/atomic_file.h"
#include "plenoflame/image/light_field.h"
#include "plenoflame/image/png_file.h"
#include "plenoflame/image/staging_folder.h"
#include "plenoflame/lightfield/develop.h"
#include "plenoflame/lightfield/export.h"
#include "plenoflame/scene/scene_file.h"
#include "plenoflame/volumes/flame_generators.h"
#include "plenoflame/volumes/vdb_info.h"
#include "vtk_commands.h"
#include "widgets/flame/flame_dialogs.h"
#include "widgets/image/image_panel.h"
#include "widgets/image/light_field_panel.h"
#include "widgets/panels/reconstruct_panel.h"
#include "widgets/scene/scene_view.h"
#include "widgets/window/file_tasks.h"
#include "widgets/window/import_dialog.h"
#include "widgets/window/main_window.h"
#include "widgets/window/poster_dialog.h"

// Files that the window reads and writes besides scenes: exports, generated and imported flames.
namespace plenoflame::desktop {

void MainWindow::say_written(const QString& name) {
  statusBar()->showMessage(tr("written to %1").arg(name), 8000);
}

QString MainWindow::folder_to_fill(const QString& title) {
  const QString folder = chooser_.folder(this, title);
  if (folder.isEmpty()) return folder;
  if (!QDir(folder).isEmpty() && !unattended_ &&
      QMessageBox::question(
          this, title,
          tr("%1 has files in it; those of the same names are replaced. Go on?").arg(folder)) !=
          QMessageBox::Yes)
    return {};
  return folder;
}

void MainWindow::make_export_menu(QMenu& menu) {
  const auto add = [&](const QString& text, const char* name, auto act) {
    QAction* const action = menu.addAction(text);
    action->setObjectName(name);
    connect(action, &QAction::triggered, this, act);
  };
  add(tr("Light field (.exr) or developed picture (.png)..."), "exportImage",
      [this] { export_image(); });
  add(tr("Rays of the selection..."), "exportRaysAction", [this] { export_rays(); });
  add(tr("Picture of any size..."), "exportPoster", [this] { export_poster(); });
  add(tr("Picture of the 3-D view..."), "exportScenePicture",
      [this] { export_picture_of_scene(); });
  add(tr("Picture of the light-field panel..."), "exportDerivedAction",
      [this] { export_derived(); });
  add(tr("All views..."), "exportViews", [this] { export_views(); });
  QMenu* const tools = menu.addMenu(tr("For another tool"));
  tools->setToolTipsVisible(true);
  for (const ExportName& format : export_formats()) {
    QAction* const action = tools->addAction(QString(format.name) + "...");
    action->setToolTip(format.what);
    connect(action, &QAction::triggered, this,
            [this, format = format.format] { export_for_tool(static_cast<int>(format)); });
  }
}

void MainWindow::export_derived() {
  if (light_field_->tab() == LightFieldPanel::Tab::raw) return export_image();
  if (light_field_->tab() == LightFieldPanel::Tab::reconstruction) return save_reconstruction();
  const auto image = light_field_->shown_image();
  const auto field = session_.document().image();
  if (!image || !field) return fail(tr("There is no picture in the light-field panel yet."));
  const QString name =
      chooser_.file_to_write(this, tr("Export the picture"), light_field_->shown_name() + ".png",
                             tr("Picture (*.png);;Values (*.exr)"));
  if (name.isEmpty()) return;
  const bool values = name.endsWith(".exr", Qt::CaseInsensitive);
  if (!values && !name.endsWith(".png", Qt::CaseInsensitive))
    return fail(tr("'%1' must end in .exr or .png").arg(name));
  files_->add(
      tr("export of the picture"),
      [name, values, image, field,
       unit =
           light_field_->shown_name() == "depth" ? "m" : "W/(m^2 sr)"](const Execution& execution) {
        LightField derived;
        derived.sensor_width = image->width;
        derived.sensor_height = image->height;
        derived.window = {0, 0, image->width, image->height};
        derived.channels.push_back({field->channels.front().name, *image, {}});
        derived.unit = unit;
        derived.estimator = field->estimator;
        derived.seed = field->seed;
        derived.samples = field->samples;
        derived.version = field->version;
        if (values) return write_light_field(name.toStdString(), derived, execution.stop);
        DevelopSpec settings;
        settings.bits = 16;
        write_png(name.toStdString(), develop(derived, settings).picture, execution.stop);
      },
      [this, name] { say_written(name); });
}

void MainWindow::export_views() {
  const auto field = session_.document().image();
  const auto views = session_.light_field().views();
  if (!field || !views)
    return fail(tr("There are no views yet: show the light-field panel and wait for them."));
  const QString folder = folder_to_fill(tr("Folder for the views"));
  if (folder.isEmpty()) return;
  files_->add(
      tr("export of %1 views").arg(views->views.size()),
      [folder, field, views](const Execution& execution) {
        StagingFolder staging(folder.toStdString());
        std::vector<NamedImage> images;
        for (const View& view : views->views)
          images.push_back({QString("view_%1_%2")
                                .arg(view.row, 2, 10, QChar('0'))
                                .arg(view.column, 2, 10, QChar('0'))
                                .toStdString(),
                            view.image,
                            {}});
        images.push_back({"contact", contact_sheet(*views), {}});
        write_pngs(staging.path(), images, *field, execution);
        write_exrs(staging.path(), images, field->channels.front().name, views->unit, *field,
                   execution);
        staging.commit();
      },
      [] {});
}

void MainWindow::export_for_tool(int format) {
  const auto field = session_.document().image();
  const auto scene = session_.compiler().compiled();
  if (!field || !scene) return fail(tr("There is no image yet."));
  ExportSettings settings;
  settings.format = static_cast<ExportFormat>(format);
  // A picture that is older than the last change was taken by the camera that was there then.
  CameraSpec spec = scene->scene.camera;
  if (!guarded([&] {
        if (!session_.document().image_is_current())
          spec = parse_scene(field->scene_text, "scene of the picture").scene.camera;
        check_export(Camera(spec), settings.format);
      }))
    return;
  const QString folder = folder_to_fill(tr("Folder for the export"));
  if (folder.isEmpty()) return;
  auto result = std::make_shared<ExportResult>();
  files_->add(
      tr("export"),
      [folder, field, spec, settings, result,
       known = session_.light_field().micro_images()](const Execution& execution) {
        const bool usable = known && known->camera().spec() == spec;
        const auto micro =
            usable ? known : std::make_shared<const MicroImages>(Camera(spec), true, execution);
        StagingFolder staging(folder.toStdString());
        *result = export_light_field(*field, *micro, settings, staging.path(), execution);
        staging.commit();
      },
      [this, result, folder] {
        // The command's notes: where the tool cannot say all that is known.
        QStringList lines{
            tr("%1 files written to %2").arg(result->files.size()).arg(QDir(folder).dirName())};
        for (const std::string& note : result->notes) lines << QString::fromStdString(note);
        last_message_ = lines.join("; ");
        statusBar()->showMessage(last_message_, 20000);
      });
}

/// An example whose flame is a file gets it first, made as the commands at the example's head say.
bool MainWindow::open_example(const QString& name) {
  if (!may_discard()) return false;
  return guarded([&] {
    QFile file(":/examples/" + name + ".toml");
    if (!file.open(QIODevice::ReadOnly))
      throw FileError("there is no example " + name.toStdString());
    const QString text = QString::fromUtf8(file.readAll());
    const auto show = [this, name](const QString& scene) {
      session_.document().open_text(scene.toStdString(), name.toStdString() + ".toml");
      ++scenes_opened_;
      show_welcome(false);
    };
    const std::vector<ExampleFlame> flames = flames_of_example(text);
    if (flames.empty()) return show(text);
    const QString folder =
        QStandardPaths::writableLocation(QStandardPaths::AppDataLocation) + "/examples";
    files_->add(
        tr("making the flame of %1").arg(name),
        [text, flames, folder](const Execution& execution) {
          make_files_of_example(text, flames, folder, execution);
        },
        [this, show, text, folder, number = scenes_opened_] {
          if (number != scenes_opened_) return;  // another scene was opened meanwhile
          guarded([&] { show(example_with_files(text, folder)); });
        });
  });
}

void MainWindow::generate_flame() {
  GenerateDialog dialog(this);
  if (dialog.exec() != QDialog::Accepted) return;
  const std::string kind = dialog.name();
  const auto values = dialog.values();
  const QString path = chooser_.file_to_write(
      this, tr("Save the flame"), QString::fromStdString(kind) + ".vdb", tr("OpenVDB (*.vdb)"));
  if (path.isEmpty()) return;
  files_->add(
      tr("flame %1").arg(QString::fromStdString(kind)),
      [kind, values, path](const Execution& execution) {
        GridWriteOptions options;
        options.metadata = flame_metadata(kind, values);
        options.stop = execution.stop;
        write_flame(path.toStdString(), plenoflame::generate_flame(kind, values, execution),
                    options);
      },
      [this, path] { open(path); });
}

void MainWindow::import_flame() {
  ImportDialog dialog(chooser_, this);
  if (dialog.exec() != QDialog::Accepted) return;
  FlameImportRequest request;
  if (!guarded([&] { request = dialog.request(); })) return;
  const QString path =
      chooser_.file_to_write(this, tr("Save the flame"), "imported.vdb", tr("OpenVDB (*.vdb)"));
  if (path.isEmpty()) return;
  files_->add(
      tr("import"),
      [request, path](const Execution& execution) {
        const std::filesystem::path output(path.toStdString());
        StagingFolder staging(output.parent_path().string());
        FlameImportRequest staged = request;
        staged.output = (staging.path() / output.filename()).string();
        import_flames(staged, execution);
        staging.commit();
      },
      [this, path] { open(path); });
}

void MainWindow::map_grids(int flame) {
  Document& document = session_.document();
  if (flame < 0 || static_cast<std::size_t>(flame) >= document.scene().flames.size())
    return fail(tr("The scene has no flame from an OpenVDB file."));
  const FlameSpec before = document.scene().flames[static_cast<std::size_t>(flame)];
  const std::string file =
      (std::filesystem::path(document.scene().file).parent_path() / before.file).string();
  auto info = std::make_shared<VdbInfo>();
  files_->add(
      tr("reading the grids"), [info, file](const Execution&) { *info = vdb_info(file); },
      [this, info, before, flame] {
        MappingDialog dialog(before, *info, this);
        if (dialog.exec() != QDialog::Accepted) return;
        Scene scene = session_.document().scene();
        const auto place = static_cast<std::size_t>(flame);
        if (place >= scene.flames.size() || !(scene.flames[place] == before)) return;
        scene.flames[place] = dialog.flame();
        session_.document().change(scene, "choose grids");
      });
}

void MainWindow::choose_measured() {
  const QString path = chooser_.file_to_read(
      this, tr("Measured picture"),
      tr("Pictures of a camera (*.exr *.tif *.tiff *.png *.pgm *.jpg *.jpeg);;All files (*)"));
  if (!path.isEmpty()) open_measured(path);
}

bool MainWindow::open_measured(const QString& path, const std::function<void()>& then) {
  const Document& document = session_.document();
  const QString name = QFileInfo(path).fileName();
  if (document.is_empty() || !document.is_valid()) {
    fail(tr("%1 is a camera's picture: open the scene of that camera first").arg(name));
    return false;
  }
  auto field = std::make_shared<std::shared_ptr<const LightField>>();
  files_->add(
      tr("reading %1").arg(name),
      [path, field, scene = document.scene_of_camera().scene](const Execution& execution) {
        *field = read_measured(path.toStdString(), scene, execution);
      },
      [this, path, field, name, then, number = scenes_opened_] {
        if (number != scenes_opened_) return;  // it was of another scene
        const bool counts = !path.endsWith(".exr", Qt::CaseInsensitive);
        session_.measured().set(*field, name, counts ? path : QString());
        if (counts) say_gain();
        if (then) then();
      });
  return true;
}

void MainWindow::say_gain() {
  const QString name = session_.measured().name();
  statusBar()->showMessage(
      session_.measured().counts_path().isEmpty()
          ? tr("%1 keeps the gain of its import, whatever the scene's sensor has").arg(name)
          : gain_in_words(name, session_.document().camera().sensor),
      20000);
}

/// The counts of a camera's file become electrons by the scene's gain, also by another one.
void MainWindow::renew_measured() {
  const auto before = session_.measured().field();
  if (!before || !session_.document().is_valid()) return;
  const QString path = session_.measured().counts_path();
  if (path.isEmpty()) return say_gain();
  auto field = std::make_shared<std::shared_ptr<const LightField>>();
  files_->add(
      tr("reading %1").arg(session_.measured().name()),
      [path, field,
       scene = session_.document().scene_of_camera().scene](const Execution& execution) {
        *field = read_measured(path.toStdString(), scene, execution);
      },
      [this, field, before] {
        if (before != session_.measured().field()) return;
        session_.measured().renew(*field);
        say_gain();
      });
}

void MainWindow::export_rays() {
  const auto rays = session_.rays().rays();
  if (!rays) return fail(tr("Nothing is selected: click a pixel first."));
  const QString name =
      chooser_.file_to_write(this, tr("Export rays"), "rays.vtp",
                             tr("VTK PolyData (*.vtp);;Table (*.csv);;JSON (*.json)"));
  if (name.isEmpty()) return;
  files_->add(
      tr("export of rays"),
      [name, rays](const Execution&) { write_ray_paths(name.toStdString(), rays->paths); },
      [this, name, rays] {
        statusBar()->showMessage(tr("%1 rays written to %2").arg(rays->paths.rays.size()).arg(name),
                                 8000);
      });
}

void MainWindow::save_reconstruction() {
  const auto found = reconstruct_->job().result();
  if (!found) return fail(tr("There is no reconstruction yet."));
  const QString name =
      chooser_.file_to_write(this, tr("Save what was found"), "found.vdb", tr("OpenVDB (*.vdb)"));
  if (name.isEmpty()) return;
  files_->add(
      tr("saving what was found"),
      [name, found](const Execution&) {
        write_estimate(name.toStdString(), found->result, found->unknowns());
      },
      [this, name] { say_written(name); });
}

void MainWindow::export_image() {
  const auto field = session_.document().image();
  if (!field) return fail(tr("There is no image yet."));
  const QString name =
      chooser_.file_to_write(this, tr("Export the light field"), "lightfield.exr",
                             tr("Raw light field (*.exr);;Developed picture (*.png)"));
  if (name.isEmpty()) return;
  const bool raw = name.endsWith(".exr", Qt::CaseInsensitive);
  if (!raw && !name.endsWith(".png", Qt::CaseInsensitive))
    return fail(tr("'%1' must end in .exr or .png").arg(name));
  files_->add(
      tr("export of the light field"),
      [name, raw, field,
       settings = session_.document().scene().develop](const Execution& execution) {
        if (raw) return write_light_field(name.toStdString(), *field, execution.stop);
        write_png(name.toStdString(), develop(*field, settings).picture, execution.stop);
      },
      [this, name] { say_written(name); });
}

void MainWindow::export_picture_of_scene() {
  write_picture(scene_view_->picture(), tr("Picture of the 3-D view"));
}

void MainWindow::export_poster() {
  PosterDialog dialog(this);
  if (dialog.exec() != QDialog::Accepted) return;
  write_picture(make_poster(dialog.poster(), *scene_view_, *image_), tr("Export a picture"));
}

void MainWindow::write_picture(const QImage& picture, const QString& title) {
  const QString name = chooser_.file_to_write(this, title, "scene.png", tr("Pictures (*.png)"));
  if (name.isEmpty()) return;
  files_->add(
      tr("export of the picture"),
      [name, picture](const Execution&) {
        QByteArray bytes;
        QBuffer buffer(&bytes);
        if (!picture.save(&buffer, "PNG")) throw FileError("the picture cannot be made a PNG");
        write_file(name.toStdString(), bytes.toStdString());
      },
      [this, name] { say_written(name); });
}

}  // namespace plenoflame::desktop
