// Prints the sensor table as CSV: a row per measured range z, a column per expected range d, both
// in pixels.
#include "racecar_mcl/sensor_table.h"

#include <fstream>
#include <iostream>
#include <limits>
#include <stdexcept>
#include <string>

#include "program.h"

namespace racecar_mcl {
namespace {

struct Options {
  SensorTableParameters parameters;
  bool header = false;
  std::string out;
};

void addOptions(Options* o, CLI::App* app) {
  SensorTableParameters& p = o->parameters;
  app->option_defaults()->always_capture_default();
  app->add_option("--alpha-hit", p.alpha_hit, "share of beams that return from the map");
  app->add_option("--alpha-short", p.alpha_short, "share stopped early");
  app->add_option("--alpha-max", p.alpha_max, "share without a return");
  app->add_option("--alpha-rand", p.alpha_rand, "share of noise");
  app->add_option("--sigma-hit", p.sigma_hit, "spread of a hit, pixels");
  app->add_option("--table-width", p.table_width, "rows and columns");
  app->add_flag("--header", o->header, "name the columns in a first line");
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
  const Eigen::ArrayXXd table = makeSensorTable(o.parameters);
  if (o.out.empty()) {
    print(table, o.header, std::cout);
    if (!std::cout) throw std::runtime_error("stdout: the table could not be written whole");
    return;
  }
  std::ofstream file(o.out);
  print(table, o.header, file);
  if (!file) throw std::runtime_error(o.out + ": the table could not be written");
}

}  // namespace
}  // namespace racecar_mcl

int main(int argc, char** argv) {
  return racecar_mcl::runProgram(
      argc, argv, "sensor_table",
      "Prints the sensor table T(z, d) as CSV: a row per measured range z, a column per expected "
      "range d, in pixels.",
      racecar_mcl::addOptions, racecar_mcl::run);
}
