"""What a simulation gets wrong, and why: one stage a file, each a function with a frozen result (EFFECTS.md 4)."""
