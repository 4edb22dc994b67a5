#include "model/example_flames.h"

#include <QDir>
#include <QFile>
#include <QRegularExpression>

#include "plenoflame/base/error.h"
#include "plenoflame/image/atomic_file.h"
#include "plenoflame/volumes/flame_file.h"

namespace plenoflame::desktop {
namespace {

/// A value that names a file beside the example.
QRegularExpression named_file() {
  return QRegularExpression(R"re(= "([^"/]+\.(?:vdb|csv))")re");
}

}  // namespace

std::vector<ExampleFlame> flames_of_example(const QString& text) {
  static const QRegularExpression command(
      R"re(^#\s+plenoflame flame (\S+)(.*) -o examples/(\S+\.vdb)$)re",
      QRegularExpression::MultilineOption);
  static const QRegularExpression option(R"re(--(set|line) "([^"]+)")re");
  std::vector<ExampleFlame> flames;
  for (auto commands = command.globalMatch(text); commands.hasNext();) {
    const QRegularExpressionMatch found = commands.next();
    ExampleFlame flame{found.captured(1).toStdString(), {}, found.captured(3)};
    QStringList lines;
    for (auto options = option.globalMatch(found.captured(2)); options.hasNext();) {
      const QRegularExpressionMatch given = options.next();
      const QString value = given.captured(2);
      if (given.captured(1) == "set") {
        flame.values[value.section('=', 0, 0).toStdString()] = value.section('=', 1).toStdString();
      } else {
        lines << value;
      }
    }
    if (!lines.isEmpty()) flame.values["lines"] = lines.join(',').toStdString();
    flames.push_back(std::move(flame));
  }
  return flames;
}

QString example_with_files(const QString& text, const QString& folder) {
  QString escaped = folder;  // as in a basic string of TOML
  escaped.replace('\\', "\\\\").replace('"', "\\\"");
  QString out;
  qsizetype done = 0;
  for (auto names = named_file().globalMatch(text); names.hasNext();) {
    const QRegularExpressionMatch name = names.next();
    out += text.mid(done, name.capturedStart() - done);
    out += QString("= \"%1/%2\"").arg(escaped, name.captured(1));
    done = name.capturedEnd();
  }
  return out + text.mid(done);
}

void make_files_of_example(const QString& text, const std::vector<ExampleFlame>& flames,
                           const QString& folder, const Execution& execution) {
  if (!QDir().mkpath(folder))
    throw FileError("the folder '" + folder.toStdString() + "' cannot be made");
  const QDir place(folder);
  for (const ExampleFlame& flame : flames) {
    GridWriteOptions options;
    options.metadata = flame_metadata(flame.generator, flame.values);
    options.stop = execution.stop;
    write_flame(place.filePath(flame.file).toStdString(),
                generate_flame(flame.generator, flame.values, execution), options);
  }
  for (auto names = named_file().globalMatch(text); names.hasNext();) {
    const QString name = names.next().captured(1);
    if (!name.endsWith(".csv")) continue;
    QFile table(":/examples/" + name);
    if (!table.open(QIODevice::ReadOnly))
      throw FileError("the table '" + name.toStdString() + "' of the example is not there");
    const QByteArray bytes = table.readAll();
    write_file(place.filePath(name).toStdString(),
               {bytes.constData(), static_cast<std::size_t>(bytes.size())});
  }
}

}  // namespace plenoflame::desktop
