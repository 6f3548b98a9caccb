//! What goes out, followed from state to state.
