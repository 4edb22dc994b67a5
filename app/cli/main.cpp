#include "run.h"

int main(int argc, char** argv) {
  return plenoflame::cli::run(argc, argv);
}
