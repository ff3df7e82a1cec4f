// LAB ONLY
#pragma once
#include <cstdlib>
#include <string>
namespace burnish::denoising {
inline double tune(const char* name, double otherwise) {
  const char* v = std::getenv(name);
  return v ? std::atof(v) : otherwise;
}
}
