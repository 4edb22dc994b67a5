#pragma once
#include <string>
#include <vector>

#include "plenoflame/image/png_file.h"
#include "plenoflame/lightfield/export.h"
#include "plenoflame/lightfield/geometry.h"

/// Helpers that the writers of the single formats share.
namespace plenoflame {

/// One export: what goes in, and what was written so far.
struct ExportJob {
  const LightField& field;
  const Image& flux;         ///< the chosen channel
  const LightField* colour;  ///< with the channels red, green, blue; nullptr: pictures are grey
  const MicroImages& micro;
  const ExportSettings& settings;
  std::string folder;
  const Execution& execution;
  ExportResult& result;

  /// Path of a file in the folder, noted as written.
  std::string file(const std::string& name) const;
  /// Writes text. @throws FileError
  void text(const std::string& name, const std::string& contents) const;
  /// Writes an image of radiance or flux as PNG through the transfer function of sRGB; `white` [its
  /// unit] becomes the largest sample. @param bits 8 or 16 @param channels 1, or 3 equal ones
  void png(const std::string& name, const Image& image, double white, int bits, int channels) const;
  /// The same of one image, in `channels` equal ones, or of red, green and blue.
  void png(const std::string& name, const std::vector<const Image*>& images, double white, int bits,
           int channels) const;
  /// The raw image: in colour, or as `channels` equal ones.
  void raw_png(const std::string& name, int bits, int channels) const;
  /// The flux that becomes white.
  double raw_white() const;
  /// The views in the format's grid.
  Views views(int grid) const;
  /// For pictures: `views` alone, or the same views in red, green and blue.
  std::vector<Views> colour_views(const Views& views) const;
};

/// The value that becomes white in pictures of the views: all views and colours are exposed alike.
double views_white(const std::vector<Views>& colours);
/// One view of each colour.
std::vector<const Image*> view_images(const std::vector<Views>& colours, std::size_t view);

/// Decimal text that reads back to the same double.
std::string number(double value);
/// The same with a point or exponent in it, for readers that distinguish integers from reals.
std::string real(double value);

void export_plenoptic_toolbox(const ExportJob& job);
void export_libpleno(const ExportJob& job);
void export_plenopticam(const ExportJob& job);
void export_pip(const ExportJob& job);
void export_hci(const ExportJob& job);
void export_plenoptomos(const ExportJob& job);
void export_eslf(const ExportJob& job);
void export_view_grid(const ExportJob& job);
void export_npz(const ExportJob& job);
void export_hdf5(const ExportJob& job);

}  // namespace plenoflame
