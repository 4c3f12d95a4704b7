# Placeholder: export set and package files.
