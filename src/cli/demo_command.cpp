#include "cli/cli.h"
namespace sg { int run_demo(const Options&, Context&) { return 0; } }
