# The checks beside the tests: source it after common.sh. Each function passes or fails, and prints why.
# A check runs where its tool is installed, in the version that Debian 12 has: others warn of other things.

# The names of the checks that can run here, fastest first.
available_checks() {
  if clang-format --version 2>/dev/null | grep -q 'version 14\.'; then echo layout; fi
  if command -v pre-commit >/dev/null; then echo files; fi
  if command -v catkin_lint >/dev/null; then echo catkin; fi
  if doxygen --version 2>/dev/null | grep -q '^1\.9\.'; then echo docs; fi
  if clang-tidy --version 2>/dev/null | grep -q 'version 14\.'; then echo tidy; fi
}

check_title() {
  case "$1" in
    layout) echo "the code layout (clang-format)" ;;
    files) echo "the files (pre-commit)" ;;
    tidy) echo "static analysis (clang-tidy)" ;;
    docs) echo "the API docs (doxygen)" ;;
    catkin) echo "the package (catkin_lint)" ;;
  esac
}

check_layout() {
  (cd "$root" && git ls-files '*.cpp' '*.h' | xargs clang-format --dry-run -Werror)
}

# The hooks that are no check of their own here.
check_files() {
  (cd "$root" && SKIP=clang-format,catkin-lint PRE_COMMIT_HOME=build/pre-commit pre-commit run --all-files)
}

# The libraries and programs in src/ with the headers they include, in a build that compiles files together: most of the
# time goes into the headers. The static analyzer takes half a minute for a file that includes ROS and as long as all other
# checks elsewhere, so only the localizer itself gets it.
check_tidy() {
  configure_in build/analysis -DCMAKE_EXPORT_COMPILE_COMMANDS=ON -DRACECAR_MCL_ANALYSIS=ON \
    -DCATKIN_ENABLE_TESTING=OFF || return 1
  local failed=0
  tidy '' 'core|map_io' || failed=1
  tidy '-clang-analyzer-*' 'apps|calibration|evaluation|map_changes|offline|ros|sim' || failed=1
  return $failed
}

# tidy CHECKS FOLDERS: runs clang-tidy over what the build compiles of these folders of src/ (a regular expression), with
# CHECKS added to those in .clang-tidy. The analyzer has to be told to report errors in included files, and is shallow,
# since a deep analysis doubles the time of the core's checks.
tidy() {
  local build="$root/build/analysis"
  sed -nE "s#^ *\"file\": \"($root/(build/analysis/)?src/($2)/.*)\",?\$#\1#p" "$build/compile_commands.json" |
    xargs -P "$(build_jobs)" -n 1 clang-tidy -p "$build" --quiet --checks="$1" \
      --extra-arg=-Xclang --extra-arg=-analyzer-opt-analyze-headers \
      --extra-arg=-Xclang --extra-arg=-analyzer-config --extra-arg=-Xclang --extra-arg=mode=shallow \
      2> >(grep -v 'warnings.* generated' >&2)
}

check_docs() {
  mkdir -p "$root/build"
  (cd "$root" && rm -rf build/api && doxygen docs/Doxyfile)
}

check_catkin() {
  (cd "$root" && catkin_lint --config .catkin_lint .)
}
