"""Long arrays in bounded memory: pieces of work, arrays in files, numbers by their rank."""
