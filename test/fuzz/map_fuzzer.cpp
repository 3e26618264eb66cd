// A map: the YAML, a line "%image", and the image.
#include "fuzz_input.h"
#include "racecar_mcl/common/errors.h"
#include "racecar_mcl/map/map_io.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace racecar_mcl;
  const std::string text(data, data + size);
  const std::string separator = "%image\n";
  const std::size_t yaml = std::min(text.find(separator), text.size());
  writeFuzzFile("map.pgm", yaml < text.size() ? text.substr(yaml + separator.size()) : "");
  try {
    loadMap(writeFuzzFile("map.yaml", text.substr(0, yaml)));
  } catch (const MapError&) {
    // The only error a file may cause.
  }
  return 0;
}
