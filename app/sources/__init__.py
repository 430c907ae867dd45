"""Where the senses of a session come from: a simulated robot, or a recording of a real one."""
