#include "map_changes/map_change_report.h"

#include <cstdio>

namespace racecar_mcl {
namespace {

/// `format`: number, kind, x, y, size along columns and rows, cells, views.
std::string rows(const MapChanges& changes, const char* format) {
  std::string text;
  int number = 0;
  for (const ChangedRegion& region : changes.regions) {
    char line[160];
    std::snprintf(line, sizeof(line), format, ++number, toString(region.kind).c_str(),
                  region.centre_in_map.x(), region.centre_in_map.y(), region.size.x(),
                  region.size.y(), region.cells, region.views);
    text += line;
  }
  return text;
}

}  // namespace

std::string changesText(const MapChanges& changes) {
  std::string text = "cells:";
  for (const CellChange change :
       {CellChange::kNew, CellChange::kGone, CellChange::kExplored, CellChange::kConfirmed,
        CellChange::kUnclear, CellChange::kNotSeen}) {
    text += " " + std::to_string(changes.count(change)) + " " + toString(change) + ",";
  }
  text.back() = '\n';
  if (changes.regions.empty()) return text + "no region changed\n";
  text += "   #  kind      x (m)     y (m)      size (m)    cells  views\n";
  return text + rows(changes, "%4d  %-4s %10.2f%10.2f  %6.2f x %-6.2f%7d%7u\n");
}

std::string changesCsv(const MapChanges& changes) {
  return "number,kind,x,y,size_columns,size_rows,cells,views\n" +
         rows(changes, "%d,%s,%.3f,%.3f,%.3f,%.3f,%d,%u\n");
}

}  // namespace racecar_mcl
