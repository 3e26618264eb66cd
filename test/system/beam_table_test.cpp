#include <gtest/gtest.h>

#include <cmath>
#include <sstream>
#include <vector>

#include "support/program.h"

namespace racecar_mcl {
namespace {

using Table = std::vector<std::vector<double>>;

Table parseCsv(const std::string& text) {
  Table table;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    table.emplace_back();
    std::istringstream fields(line);
    for (std::string field; std::getline(fields, field, ',');) {
      table.back().push_back(std::stod(field));
    }
  }
  return table;
}

/// Direct evaluation of the formulas: T[z][d].
Table expectedTable(double hit, double shortened, double max, double rand, double sigma,
                    int width) {
  const int last = width - 1;
  const auto size = static_cast<std::size_t>(width);
  Table table(size, std::vector<double>(size));
  for (int d = 0; d < width; ++d) {
    const auto gauss = [&](int z) { return std::exp(-0.5 * std::pow((z - d) / sigma, 2)); };
    double gauss_sum = 0.0;
    for (int z = 0; z < width; ++z) gauss_sum += gauss(z);
    double sum = 0.0;
    std::vector<double> column;
    for (int z = 0; z < width; ++z) {
      double p = hit * gauss(z) / gauss_sum + rand / last;
      if (z <= d && d != 0) p += shortened * (2.0 / d) * (1.0 - static_cast<double>(z) / d);
      if (z == last) p += max;
      column.push_back(p);
      sum += p;
    }
    for (std::size_t z = 0; z < size; ++z) table[z][static_cast<std::size_t>(d)] = column[z] / sum;
  }
  return table;
}

void expectEqual(const Table& actual, const Table& expected) {
  ASSERT_EQ(actual.size(), expected.size());
  double worst = 0.0;
  for (std::size_t z = 0; z < expected.size(); ++z) {
    ASSERT_EQ(actual[z].size(), expected.size());
    for (std::size_t d = 0; d < expected.size(); ++d) {
      worst = std::max(worst, std::abs(actual[z][d] - expected[z][d]));
    }
  }
  EXPECT_LT(worst, 1e-14);
}

TEST(SensorTableProgram, printsTheFormulasWithTheDefaultConstants) {
  const ProgramResult result = runProgram(BEAM_TABLE_PROGRAM, {});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Table table = parseCsv(result.out);
  expectEqual(table, expectedTable(0.74, 0.07, 0.07, 0.12, 8.0, 201));
  for (std::size_t d = 0; d < table.size(); ++d) {
    double sum = 0.0;
    for (const std::vector<double>& row : table) sum += row[d];
    EXPECT_NEAR(sum, 1.0, 1e-12) << "column " << d;
  }
}

TEST(SensorTableProgram, takesEveryConstantAndWritesToAFile) {
  const TemporaryDirectory folder;
  const std::string path = (folder.path() / "table.csv").string();
  const ProgramResult result =
      runProgram(BEAM_TABLE_PROGRAM, {"--alpha-hit", "0.5", "--alpha-short", "0.2", "--alpha-max",
                                      "0.2", "--alpha-rand", "0.1", "--sigma-hit", "2.5",
                                      "--table-width", "51", "--header", "--out", path});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.out, "");
  const std::string text = readWhole(path);
  EXPECT_EQ(text.substr(0, 8), "d=0,d=1,");
  expectEqual(parseCsv(text.substr(text.find('\n') + 1)),
              expectedTable(0.5, 0.2, 0.2, 0.1, 2.5, 51));
}

TEST(SensorTableProgram, refusesSharesThatDoNotAddUpUnknownOptionsAndUnwritableFiles) {
  const ProgramResult shares = runProgram(BEAM_TABLE_PROGRAM, {"--alpha-hit", "0.9"});
  EXPECT_EQ(shares.exit_code, 1);
  EXPECT_EQ(shares.out, "");
  EXPECT_NE(shares.err.find("it must be 1"), std::string::npos) << shares.err;
  const ProgramResult option = runProgram(BEAM_TABLE_PROGRAM, {"--sigma", "3"});
  EXPECT_EQ(option.exit_code, 1);
  EXPECT_NE(option.err.find("--sigma"), std::string::npos) << option.err;
  const ProgramResult file = runProgram(BEAM_TABLE_PROGRAM, {"--out", "/no/such/folder/t.csv"});
  EXPECT_EQ(file.exit_code, 1);
  EXPECT_NE(file.err.find("/no/such/folder/t.csv"), std::string::npos) << file.err;
}

}  // namespace
}  // namespace racecar_mcl
