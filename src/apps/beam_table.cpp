// Prints the beam model's table as CSV: one row per measured range z, one column per expected range
// d, in pixels.
#include "racecar_mcl/sensor/beam_table.h"

#include <fstream>
#include <iostream>
#include <limits>
#include <stdexcept>
#include <string>

#include "cli.h"

namespace racecar_mcl {
namespace {

struct Options {
  BeamTableParameters parameters;
  bool header = false;
  std::string out;
};

void addOptions(Options* o, CLI::App* app) {
  BeamTableParameters& p = o->parameters;
  app->option_defaults()->always_capture_default();
  app->add_option("--alpha-hit", p.alpha_hit, "weight of hits");
  app->add_option("--alpha-short", p.alpha_short, "weight of short returns");
  app->add_option("--alpha-max", p.alpha_max, "weight of missing returns");
  app->add_option("--alpha-rand", p.alpha_rand, "weight of random returns");
  app->add_option("--sigma-hit", p.sigma_hit, "standard deviation of hits, pixels");
  app->add_option("--table-width", p.table_width, "number of rows and of columns");
  app->add_flag("--header", o->header, "write a header line");
  app->add_option("--out", o->out, "write to this file instead of stdout");
}

void print(const Eigen::ArrayXXd& table, bool header, std::ostream& out) {
  out.precision(std::numeric_limits<double>::max_digits10);
  if (header) {
    for (Eigen::Index d = 0; d < table.cols(); ++d) out << (d > 0 ? "," : "") << "d=" << d;
    out << '\n';
  }
  for (Eigen::Index z = 0; z < table.rows(); ++z) {
    for (Eigen::Index d = 0; d < table.cols(); ++d) out << (d > 0 ? "," : "") << table(z, d);
    out << '\n';
  }
  out.flush();
}

void run(const Options& o) {
  const Eigen::ArrayXXd table = makeBeamTable(o.parameters);
  if (o.out.empty()) {
    print(table, o.header, std::cout);
    if (!std::cout) throw std::runtime_error("stdout: cannot write the whole table");
    return;
  }
  std::ofstream file(o.out);
  print(table, o.header, file);
  if (!file) throw std::runtime_error(o.out + ": cannot write the table");
}

}  // namespace
}  // namespace racecar_mcl

int main(int argc, char** argv) {
  return racecar_mcl::runProgram(
      argc, argv, "beam_table",
      "Prints the beam model's table T(z, d) as CSV: one row per measured range z, one column per "
      "expected range d, in pixels.",
      racecar_mcl::addOptions, racecar_mcl::run);
}
