#pragma once
#include <string>
#include <vector>

#include "plenoflame/film/film.h"

namespace plenoflame {

/// Keeps a film in a file, bit for bit, so that an interrupted run can be continued.
/// @param key what the film belongs to (scene, settings, version): it is compared when reading
/// @throws FileError
void write_checkpoint(const std::string& path, const Film& film, const std::string& key);
/// The same of several, for runs that make one picture of many. Films without a window are kept as
/// such.
void write_checkpoint(const std::string& path, const std::vector<const Film*>& films,
                      const std::string& key);

/// The run of a kept film. @throws FileError (cannot be read, damaged, not such a file)
std::string read_checkpoint_key(const std::string& path);

/// @throws FileError (cannot be read, damaged, not a single film), InputError (another scene, other
///         settings or another version: says so)
Film read_checkpoint(const std::string& path, const std::string& key);
/// As many films as there are. @throws as read_checkpoint()
std::vector<Film> read_checkpoint_films(const std::string& path, const std::string& key);

}  // namespace plenoflame
