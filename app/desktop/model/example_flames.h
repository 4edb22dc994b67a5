#pragma once
#include <QString>
#include <string>
#include <vector>

#include "plenoflame/base/execution.h"
#include "plenoflame/volumes/flame_generators.h"

namespace plenoflame::desktop {

/// A flame that an example reads from a file, and how that is made.
struct ExampleFlame {
  std::string generator;
  FlameValues values;
  QString file;  ///< its name, without a folder
};

/// The flames that an example needs, by the commands `plenoflame flame ...` in its comments.
std::vector<ExampleFlame> flames_of_example(const QString& text);

/// The example with its flames and tables in a folder.
QString example_with_files(const QString& text, const QString& folder);

/// Writes the flames into the folder, which is made, and the tables that the example names.
/// @throws FileError where a file cannot be written
void make_files_of_example(const QString& text, const std::vector<ExampleFlame>& flames,
                           const QString& folder, const Execution& execution);

}  // namespace plenoflame::desktop
