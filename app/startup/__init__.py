"""Starting: compiling the kernels, waking the engine. And ending: exit codes and signals."""
