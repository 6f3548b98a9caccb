//! MQTT 3.1.1 on the server's side. The modules are still part of the program, which names them by their paths.
