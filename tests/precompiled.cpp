// Holds the precompiled header of the tests; main.cpp asks doctest for more than that has.
