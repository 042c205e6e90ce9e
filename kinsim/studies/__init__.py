"""Many runs on one mechanism: members, where finished ones are kept, who runs them, and one dataset of it all."""
