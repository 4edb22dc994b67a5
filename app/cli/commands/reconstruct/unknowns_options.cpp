#include "commands/reconstruct/unknowns_options.h"

#include <CLI/CLI.hpp>

#include "choice.h"

namespace plenoflame::cli {

void add_unknowns_options(CLI::App& command, UnknownsRequest& arguments) {
  command
      .add_option("--unknowns", arguments.kind,
                  "voxels; rings x heights around an axis; ellipsoidal layers that fill the block "
                  "(voxels)")
      ->check(one_of({"voxels", "rings", "layers"}))
      ->option_text("KIND");
  command
      .add_option("--grid", arguments.grid,
                  "Voxels along the longest side or along all three, NX,NY,NZ (32); rings and "
                  "heights, N,M (40,80); layers (10)")
      ->option_text("N[,N,N]");
  command
      .add_option("--center", arguments.centre,
                  "Middle of the block, \"1 m, 0 m, 5 mm\"; without it, that of the scene's flames")
      ->option_text("X,Y,Z");
  command
      .add_option("--size", arguments.size,
                  "Its sides, \"40 mm, 40 mm, 60 mm\", or auto: those of the scene's flames, or by "
                  "the pictures (auto)")
      ->option_text("X,Y,Z");
  command
      .add_option("--axis", arguments.axis,
                  "Direction of the rings' axis through the block's middle (\"0 m, 0 m, 1 m\"), or "
                  "fit: place and direction by the pictures")
      ->option_text("X,Y,Z");
  command.add_option("--basis", arguments.basis, "Of voxels: trilinear or constant (trilinear)")
      ->check(one_of({"trilinear", "constant"}))
      ->option_text("KIND");
  command
      .add_option("--absorption", arguments.absorption,
                  "Known absorption: none (no temperature is found), a value like \"8 1/m\" "
                  "everywhere, or scene: that of the scene's flames (none)")
      ->option_text("WHICH");
}

void add_rows_options(CLI::App& command, std::string& bin, std::string& cells) {
  command
      .add_option("--bin", bin,
                  "Pixels of a row: N for blocks of N x N, micro-image, or view: the cells of "
                  "--cells within each micro-image (1)")
      ->option_text("N|micro-image|view");
  command.add_option("--cells", cells, "Of --bin view: parts of a micro-image along each side (3)")
      ->option_text("N");
}

}  // namespace plenoflame::cli
