// What search_cells.cpp is made of, for the registers that the including file has chosen (no include guard of
// its own: once a translation unit).
#include "cell_grid.cpp"
#include "cell_search.cpp"
#include "neighbourhood.cpp"
#include "pair_test.cpp"
#include "search_cells.cpp"
#include "slice_encoder.cpp"
