// Prints the sensor table as CSV: a row per measured range z, a column per expected range d, both
// in pixels.
#include "racecar_mcl/sensor_table.h"

#include <fstream>
#include <iostream>
#include <limits>
#include <stdexcept>
#include <string>

#include "program.h"

namespace {

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

}  // namespace

int main(int argc, char** argv) {
  racecar_mcl::SensorTableParameters parameters;
  bool header = false;
  std::string path;

  CLI::App app(
      "Prints the sensor table T(z, d) as CSV: a row per measured range z, a column per expected "
      "range d, in pixels.",
      "sensor_table");
  app.option_defaults()->always_capture_default();
  app.add_option("--alpha-hit", parameters.alpha_hit, "share of beams that return from the map");
  app.add_option("--alpha-short", parameters.alpha_short, "share stopped early");
  app.add_option("--alpha-max", parameters.alpha_max, "share without a return");
  app.add_option("--alpha-rand", parameters.alpha_rand, "share of noise");
  app.add_option("--sigma-hit", parameters.sigma_hit, "spread of a hit, pixels");
  app.add_option("--table-width", parameters.table_width, "rows and columns");
  app.add_flag("--header", header, "name the columns in a first line");
  app.add_option("--out", path, "write to this file instead of stdout");

  return racecar_mcl::runProgram(app, argc, argv, [&] {
    const Eigen::ArrayXXd table = racecar_mcl::makeSensorTable(parameters);
    if (path.empty()) {
      print(table, header, std::cout);
      if (!std::cout) throw std::runtime_error("stdout: the table could not be written whole");
      return;
    }
    std::ofstream file(path);
    print(table, header, file);
    if (!file) throw std::runtime_error(path + ": the table could not be written");
  });
}
