# La pagina dei comandi del simulatore.

simulator-title = Simulatore
simulator-viewer = Accesso come osservatore: si vede il simulatore e si può premere STOP. Per tutto il resto serve la chiave di un operatore.
simulator-about = Questi comandi cambiano la sala simulata e i suoi robot, non la missione: in un simulatore in pausa i robot non si muovono. STOP agisce subito, anche in pausa.

## Il tempo.

simulator-time = Tempo
simulator-paused = In pausa: il tempo simulato è fermo.
simulator-runs = In corso a { $factor } × il tempo reale.
simulator-runs-max = In corso alla massima velocità possibile.
simulator-go-on = Riprendere
simulator-pause = Pausa
simulator-step = Un passo<small>fino alla fine dell'ordine in corso</small>
simulator-step-unpaused = Un passo<small>solo in pausa</small>
simulator-speed = Velocità
simulator-speed-max = la massima possibile
simulator-set-speed = Impostare la velocità

## I guasti del robot, con il nome di quello che succede.

simulator-faults = Guasti del robot
simulator-well-linkLost = Collegamento: a posto
simulator-failing-linkLost = Collegamento: interrotto
simulator-means-linkLost = senza collegamento il robot si ferma da solo e la missione è bloccata
simulator-bring-linkLost = Interrompere il collegamento
simulator-mend-linkLost = Ripristinare il collegamento
simulator-well-noThermometer = Termometro: a posto
simulator-failing-noThermometer = Termometro: mancante
simulator-means-noThermometer = senza termometro il robot non invia misure
simulator-bring-noThermometer = Togliere il termometro
simulator-mend-noThermometer = Rimettere il termometro
simulator-well-cameraFails = Fotocamera: a posto
simulator-failing-cameraFails = Fotocamera: guasta
simulator-means-cameraFails = quando la fotocamera è guasta, nessuna foto riesce
simulator-bring-cameraFails = Guastare la fotocamera
simulator-mend-cameraFails = Riparare la fotocamera

## Un passaggio ostruito.

simulator-way = Ostacoli
simulator-way-about = Si possono aggiungere ostacoli che non fanno parte della sala. In una cella con un robot, l'ostacolo appare quando il robot si è spostato.
simulator-block-ahead = Ostruire il passaggio davanti
simulator-block = Ostruire questa cella
simulator-free = Liberare { $cell }
simulator-nothing-blocked = Nessuna cella è ostruita.

## La sala.

simulator-hall = Sala
simulator-hall-now = I robot sono in <b>{ $hall }</b>: { $columns } × { $rows } celle di { $side } m, { $pieces ->
    [one] { $pieces } bagaglio
   *[other] { $pieces } bagagli
}; seme { $seed }.
simulator-seed = Seme
simulator-put-down = Usare questa sala
simulator-bound = Al momento: { $why }.
simulator-to-editor = Modificare la sala
simulator-start = AVVIA la ricerca
