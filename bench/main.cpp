#include "launch.h"

int main(int argc, char** argv) { return ragtop::bench::run(argc, argv); }
