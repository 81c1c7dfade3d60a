"""The paper's solvers, setups A to G."""
