"""What is noted down while a run goes on: the ledger, causes of change, densities."""
