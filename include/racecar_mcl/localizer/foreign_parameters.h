// Parameters of other localizers and their counterparts here: amcl, the course's lab 5 and MIT's
// particle_filter.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace racecar_mcl {

/// How a value becomes a value of the counterpart.
enum class ForeignValue {
  kCopied,      ///< the same text
  kStripped,    ///< a frame, without a leading slash
  kSquareRoot,  ///< a variance per square, here a standard deviation
  kWord,        ///< a word of a choice; the words are listed with the translation
  kCombined,    ///< together with other parameters
  kNone,        ///< no counterpart, or none that follows from the value alone; see the note
};

struct ForeignParameter {
  const char* origin;  ///< "amcl", "lab5" or "mit_pf"
  const char* name;    ///< there
  const char* ours;    ///< here; "" if there is none
  ForeignValue value;
  const char* note;  ///< what to do, or ""
};

/// The only table of foreign names; docs/migrating.md is compared with it.
const std::vector<ForeignParameter>& foreignParameters();

/// "amcl", "lab5" and "mit_pf".
std::vector<std::string> foreignOrigins();

/// What an unknown name is here, if it is a parameter of another localizer; else "".
std::string foreignHint(const std::string& name);

struct ForeignTranslation {
  std::map<std::string, std::string> parameters;  ///< of this package, by name
  std::vector<std::string> notes;                 ///< one line on each that was not translated
};

/// Translates parameters of `origin`. Names that are not its own are kept and
/// have priority. Throws
/// ParameterError on an unknown origin and on a value that has no counterpart.
ForeignTranslation translateParameters(const std::string& origin,
                                       const std::map<std::string, std::string>& texts);

}  // namespace racecar_mcl
