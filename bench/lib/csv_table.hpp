#pragma once
/// \file
/// Tables of numbers in CSV files.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace taut::bench {

/// A CSV file with a header line; lines that start with `#` are comments. Fields hold a finite number,
/// nothing, or "-" (the source's formulation broke).
class CsvTable {
 public:
  struct Cell {
    std::optional<double> value;
    bool broke = false;
  };

  /// \throws InputError "file:line: what" for a missing file, two columns of one name, a wrong number of
  /// fields or what is no finite number.
  explicit CsvTable(const std::filesystem::path& file);

  /// \throws InputError listing the valid columns.
  std::size_t column(const std::string& name) const;
  std::size_t rows() const { return cells_.size(); }
  unsigned line(std::size_t row) const { return lines_[row]; }  ///< of the file
  const Cell& at(std::size_t row, std::size_t column) const { return cells_[row][column]; }

 private:
  std::string file_;
  std::vector<std::string> header_;
  std::vector<std::vector<Cell>> cells_;
  std::vector<unsigned> lines_;
};

}  // namespace taut::bench
