// A parameter file.
#include "fuzz_input.h"
#include "racecar_mcl/common/errors.h"
#include "racecar_mcl/localizer/parameter_registry.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace racecar_mcl;
  LocalizerParameters parameters;
  try {
    readParameterFile(writeFuzzFile("parameters.yaml", std::string(data, data + size)),
                      &parameters);
    validate(parameters);
  } catch (const ParameterError&) {
    // The only error a file may cause.
  }
  return 0;
}
