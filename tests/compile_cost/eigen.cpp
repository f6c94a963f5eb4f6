// The unit of scripts/compile-cost on the host: what a program that computes with vectors includes anyway.
#include <algorithm>
#include <iostream>
#include <vector>

#include <Eigen/Core>

int main() {}
